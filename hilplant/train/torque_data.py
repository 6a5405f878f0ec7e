"""The torque of a wiper at even speeds, dry and wet, from the load model of the step itself: data for its network."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench
from hilplant.bench.plant_description import WholeWiper
from hilplant.failure import Failure
from hilplant.models import torque_samples as samples
from hilplant.units import TURN_RAD

#: Screens whose torques are the outputs: dry and wet.
WETNESSES = (0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Wipes:
    """Samples of wipes at even speeds: angle [rad] and speed [rad/s] of the crank, and torques [N m], all [m, 2]."""

    states: Floats
    torques: Floats


@dataclass(frozen=True, slots=True)
class Speeds:
    """Speeds of the crank [rad/s]: of the training, of the choice among fits, and of the separate validation."""

    training: tuple[float, ...]

    @property
    def judging(self) -> tuple[float, ...]:
        """A quarter and three quarters of the way from each speed of the training to the next."""
        pairs = zip(self.training, self.training[1:], strict=False)
        return tuple(low + part * (high - low) for low, high in pairs for part in (0.25, 0.75))

    @property
    def validation(self) -> tuple[float, ...]:
        """Half-way between the speeds of the training."""
        return tuple(0.5 * (low + high) for low, high in zip(self.training, self.training[1:], strict=False))


def wipes(bench: Bench, speeds_rad_s: Sequence[float], points: int) -> Wipes:
    """Return one wipe at each speed, at `points` even angles of the turn."""
    states = grid(speeds_rad_s, points)
    return Wipes(states, physical_torques(bench, states))


def grid(speeds_rad_s: Sequence[float], points: int) -> Floats:
    """Return `points` even angles of the turn at each speed, [m, 2]."""
    angles = (np.arange(points) + 0.5) * (TURN_RAD / points)
    speed, angle = np.meshgrid(np.asarray(speeds_rad_s, dtype=float), angles, indexing="ij")
    return np.column_stack([angle.ravel(), speed.ravel()])


def physical_torques(bench: Bench, states: Floats) -> Floats:
    """Return the torques at the crank [N m], dry and wet, at each angle and speed, in still air.

    Raises
    ------
    Failure
        When the bench has no whole wiper.

    """
    load = bench.plant.load
    if not isinstance(load, WholeWiper):
        text = f"the load of a torque network's bench must be reduced or network, not {load.model}"
        raise Failure(f"{bench.path}: {text}")
    torques = np.empty((len(WETNESSES), len(states)))
    for row, wetness in zip(torques, WETNESSES, strict=True):
        samples.physical_torques(bench.tables, bench.parameters.load, wetness, np.ascontiguousarray(states), row)
    return np.ascontiguousarray(torques.T)
