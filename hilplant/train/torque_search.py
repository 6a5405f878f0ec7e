"""Random scenarios against the physical plant: how far the network is off where it is active, and what follows."""

from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench
from hilplant.models import torque_samples as samples
from hilplant.models.load import LOADS
from hilplant.models.records import PARAMETER_INDEX, STATE_INDEX
from hilplant.progress import OnProgress, ProgressReport, unseen
from hilplant.signals import ACTIVE_MODELS, INPUT_INDEX
from hilplant.simulation.batch import simulate_batch
from hilplant.train.random_scenarios import random_inputs, random_state
from hilplant.train.torque_file import network_torques

COLUMNS = ("crank_angle_rad", "crank_speed_rad_s", "load_mode", "current_a", "park_contact")
NETWORK = ACTIVE_MODELS.index("network")

#: Scenarios that are run at once, which keeps the memory small.
_AT_ONCE = 100


@dataclass(slots=True)
class TorqueDifferences:
    """What came of the scenarios; `where` is scenario, tick, angle, speed and wetness of the worst torque.

    Torques in N m, of the ticks with the network active; `excess` is the largest part of the bound that was used.
    """

    scenarios: int = 0
    ticks: int = 0
    ticks_in_charge: int = 0
    hand_overs: int = 0
    beyond_bound: int = 0
    excess: float = 0.0
    worst_n_m: float = 0.0
    where: tuple[float, ...] = ()
    sum_n_m: float = 0.0
    sum_squared: float = 0.0
    current_squared: float = 0.0
    current_worst_a: float = 0.0
    current_range_a: float = 0.0
    park_stops: int = 0
    park_stops_differing: int = 0

    @property
    def mean_n_m(self) -> float:
        """Mean size of the torque's error."""
        return self.sum_n_m / max(1, self.ticks_in_charge)

    @property
    def rms_n_m(self) -> float:
        """Root of the mean square of the torque's error."""
        return float(np.sqrt(self.sum_squared / max(1, self.ticks_in_charge)))

    @property
    def current_rms_a(self) -> float:
        """Root of the mean square of the current's difference to the physical plant."""
        return float(np.sqrt(self.current_squared / max(1, self.ticks)))


@dataclass(frozen=True, slots=True)
class Range:
    """How many scenarios, how long each [s], and where their random numbers begin."""

    scenarios: int
    seconds: float
    seed: int


def search(
    bench: Bench, bounds: tuple[float, float], extent: Range, on_progress: OnProgress = unseen
) -> TorqueDifferences:
    """Run random scenarios with the network and with the physical load alone, and compare.

    Parameters
    ----------
    bench
        With a network load.
    bounds
        What the network's file promises [N m], dry and wet.
    extent
        How much is searched.
    on_progress
        Told of the scenarios done. A KeyboardInterrupt ends the search with what was found.

    """
    found = TorqueDifferences()
    try:
        for first in range(0, extent.scenarios, _AT_ONCE):
            seeds = [extent.seed + number for number in range(first, min(extent.scenarios, first + _AT_ONCE))]
            step_s, defaults = bench.parameters.step_s, bench.input_row
            inputs = np.array([random_inputs(seed, extent.seconds, step_s, defaults) for seed in seeds])
            ours, theirs = (_run(bench, inputs, seeds, load) for load in ("network", "reduced"))
            _compare_torques(found, bench, bounds, (ours, inputs[:, :, INPUT_INDEX["screen"]], first))
            _compare_motions(found, ours, theirs)
            on_progress(ProgressReport("random scenarios", found.scenarios, extent.scenarios))
    except KeyboardInterrupt:
        pass
    return found


def _run(bench: Bench, inputs: Floats, seeds: list[int], load: str) -> Floats:
    states = []
    for seed in seeds:
        angle, speed = random_state(seed)
        row = bench.state_row.copy()
        row[STATE_INDEX["crank_angle_rad"]] = angle
        row[STATE_INDEX["motor_speed_rad_s"]] = speed
        states.append(row)
    parameters = np.tile(bench.parameter_row, (len(seeds), 1))
    parameters[:, PARAMETER_INDEX["load.model"]] = LOADS.index(load)
    return simulate_batch(np.array(states), inputs, parameters, bench.tables, COLUMNS)


def _compare_torques(
    found: TorqueDifferences, bench: Bench, bounds: tuple[float, float], run: tuple[Floats, Floats, int]
) -> None:
    """Compare network and physical load at every angle and speed that was met with the network active."""
    rows, screens, first = run
    in_charge = rows[:, :, 2] == NETWORK
    found.scenarios += len(rows)
    found.ticks += in_charge.size
    found.ticks_in_charge += int(in_charge.sum())
    found.hand_overs += int((np.diff(in_charge.astype(int), axis=1) != 0).sum())
    states, wetness = np.ascontiguousarray(rows[in_charge][:, :2]), screens[in_charge]
    if not len(states):
        return
    network = network_torques(bench.parameters.networks, states)
    for column, bound in enumerate(bounds):
        physical = np.empty(len(states))
        samples.physical_torques(bench.tables, bench.parameters.load, float(column), states, physical)
        errors = np.where(wetness == column, np.abs(network[:, column] - physical), 0.0)
        found.beyond_bound += int((errors > bound).sum())
        found.excess = max(found.excess, float(errors.max()) / bound)
        found.sum_n_m += float(errors.sum())
        found.sum_squared += float((errors**2).sum())
        if errors.max() > found.worst_n_m:
            worst = int(errors.argmax())
            scenario, tick = (int(place[worst]) for place in np.nonzero(in_charge))
            found.worst_n_m = float(errors[worst])
            found.where = (first + scenario, tick, *map(float, states[worst]), float(column))


def _compare_motions(found: TorqueDifferences, ours: Floats, theirs: Floats) -> None:
    currents = ours[:, :, 3] - theirs[:, :, 3]
    found.current_squared += float((currents**2).sum())
    found.current_worst_a = max(found.current_worst_a, float(np.abs(currents).max()))
    found.current_range_a = max(found.current_range_a, float(np.ptp(theirs[:, :, 3])))
    closings = [(np.diff(run[:, :, 4], axis=1) > 0.5).sum(axis=1) for run in (ours, theirs)]
    found.park_stops += int(closings[1].sum())
    found.park_stops_differing += int(np.abs(closings[0] - closings[1]).sum())
