"""The trained file of a bench's load -> the numbers that the step reads; refused when made for something else."""

from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.load_files import PolynomialFile, TorqueFile
from hilplant.bench.parameter_hash import linkage_hash, load_hash
from hilplant.bench.plant_description import AnyLoad, BladeEntry, NetworkLoad, PolynomialLoad
from hilplant.bench.screen_parts import ScreenFile
from hilplant.bench.wiper import Mechanics
from hilplant.checked_yaml.spot import NAMED, Spot
from hilplant.models.records import NO_NETWORKS, Parameters
from hilplant.models.torque_network import HIGHEST, LOWEST
from hilplant.models.torque_samples import network_torques, physical_torques
from hilplant.units import TURN_RAD

#: Angles and speeds at which a network is looked at before it is trusted.
_ANGLES, _SPEEDS = 97, 5


@dataclass(frozen=True, slots=True)
class Around:
    """What a trained file must have been made for."""

    mechanics: Mechanics
    screen: ScreenFile | None
    blades: tuple[BladeEntry, BladeEntry] | None


@dataclass(frozen=True, slots=True)
class TrainedLoad:
    """The numbers of the networks' row that belong to the load, and the file they come from, if there is one."""

    numbers: Floats
    file: TorqueFile | PolynomialFile | None = None


def trained_load(spot: Spot, load: AnyLoad, around: Around) -> TrainedLoad | None:
    """Return the network of a load that has one; None when it must not be used, which is noted."""
    if isinstance(load, NetworkLoad) and around.screen is not None and around.blades is not None:
        wanted = load_hash(around.mechanics.written, around.screen, around.blades, load.points)
        return _taken(spot, load.file, wanted)
    if isinstance(load, PolynomialLoad) and load.file is not None:
        return _taken(spot, load.file, linkage_hash(around.mechanics.written))
    return TrainedLoad(NO_NETWORKS)


def check_bounds(spot: Spot, trained: TrainedLoad, parameters: Parameters, tables: Floats) -> None:
    """Note when a network is not as near to this plant's physical load as its file says."""
    if not isinstance(trained.file, TorqueFile):
        return
    bounds = trained.file.bounds
    for wetness, bound in ((0.0, bounds.dry_n_m), (1.0, bounds.wet_n_m)):
        error = worst_on_grid(parameters, tables, wetness)
        if not error <= bound:
            text = f"the network is up to {error:.3g} N m away from the physical load, and its file promises {bound:g}"
            spot.note("file", NAMED, text=f"{text}; train it again")
            return


def worst_on_grid(parameters: Parameters, tables: Floats, wetness: float) -> float:
    """Return the largest error of the network over a coarse grid of angles and speeds [N m]."""
    numbers = parameters.networks
    angles = np.linspace(0.0, TURN_RAD, _ANGLES, endpoint=False)
    speeds = np.linspace(numbers[LOWEST], numbers[HIGHEST], _SPEEDS)
    states = np.array([(angle, speed) for speed in speeds for angle in angles])
    physical, network = np.empty((2, len(states)))
    physical_torques(tables, parameters.load, wetness, states, physical)
    network_torques(numbers, wetness == 1.0, states, network)
    return float(np.abs(network - physical).max())


def _taken(spot: Spot, file: TorqueFile | PolynomialFile, wanted: str) -> TrainedLoad | None:
    if file.parameter_hash != wanted:
        ours, theirs = wanted[:16], file.parameter_hash[:16]
        text = f"this file was trained for other parameters: its hash is {theirs}, this bench's {ours}"
        spot.note("file", NAMED, text=text)
        return None
    return TrainedLoad(file.numbers(), file)
