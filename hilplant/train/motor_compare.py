"""The plant with the motor network beside the same plant with the physical motor, both left to themselves."""

from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.models.narx import NETWORK
from hilplant.models.row import pack
from hilplant.signals import INPUT_INDEX
from hilplant.simulation.batch import simulate_batch
from hilplant.train.motor_data import excitation

COLUMNS = ("current_a", "crank_speed_rad_s", "crank_angle_rad", "motor_mode")
#: Length of a run of the grid [s], and of a random one.
GRID_S, RANDOM_S = 3.0, 4.0


@dataclass(frozen=True, slots=True)
class Grid:
    """RMS error of the current [supplies, brakes] by brush and screen; not-a-number where the wiper stalls."""

    supplies_v: Floats
    brakes_n_m: Floats
    current_rms_a: dict[str, Floats]


@dataclass(frozen=True, slots=True)
class Differences:
    """Errors in the ticks in which the network was active, over runs new to it, and where the worst is."""

    runs: int
    ticks: int
    share_in_charge: float
    current_mean_a: float
    current_rms_a: float
    current_worst_a: float
    current_worst_run: int
    current_worst_s: float
    current_range_a: float
    crank_speed_mean_rad_s: float
    crank_speed_rms_rad_s: float
    crank_speed_worst_rad_s: float


def both(bench: Bench, networks: Floats, inputs: Floats) -> tuple[Floats, Floats]:
    """Return `COLUMNS` of the physical plant and of that with the network, each [runs, ticks, columns]."""
    own = bench.parameters._replace(networks=networks)
    results = []
    for model in (0.0, 1.0):
        parameters = np.tile(pack(own._replace(motor_model=model)), (len(inputs), 1))
        states = np.tile(bench.state_row, (len(inputs), 1))
        results.append(simulate_batch(states, inputs, parameters, bench.tables, COLUMNS))
    return results[0], results[1]


def random_runs(bench: Bench, networks: Floats, runs: int, seed: int) -> Differences:
    """Compare over random supplies, relays, screens and brakes; run k begins with ``default_rng([seed, 7, k])``."""
    rows = []
    for run in range(runs):
        random = np.random.default_rng([seed, 7, run])
        rows.append(excitation(bench, "fast" if run % 2 else "slow", RANDOM_S, random))
    physical, ours = both(bench, networks, np.stack(rows))
    charged = ours[:, :, 3] == NETWORK
    current, speed = ours[:, :, 0] - physical[:, :, 0], ours[:, :, 1] - physical[:, :, 1]
    worst_run, worst_tick = np.unravel_index(int((np.abs(current) * charged).argmax()), current.shape)
    return Differences(
        runs=runs,
        ticks=int(charged.sum()),
        share_in_charge=float(charged.mean()),
        current_mean_a=float(np.abs(current[charged]).mean()),
        current_rms_a=float(np.sqrt(np.mean(current[charged] ** 2))),
        current_worst_a=float(np.abs(current[charged]).max()),
        current_worst_run=int(worst_run),
        current_worst_s=float(worst_tick * bench.parameters.step_s),
        current_range_a=float(np.ptp(physical[:, :, 0])),
        crank_speed_mean_rad_s=float(np.abs(speed[charged]).mean()),
        crank_speed_rms_rad_s=float(np.sqrt(np.mean(speed[charged] ** 2))),
        crank_speed_worst_rad_s=float(np.abs(speed[charged]).max()),
    )


def over_grid(bench: Bench, networks: Floats) -> Grid:
    """Compare settled wiping at supplies from 8 to 18 V and brakes from 0 to 10 N m."""
    supplies, brakes = np.linspace(8.0, 18.0, 6), np.linspace(0.0, 10.0, 6)
    found: dict[str, Floats] = {}
    for fast, brush in enumerate(("slow", "fast")):
        for wet, screen in enumerate(("dry", "wet")):
            cases = [(volts, brake) for volts in supplies for brake in brakes]
            rows = np.tile(bench.input_row, (len(cases), round(GRID_S / bench.parameters.step_s), 1))
            rows[:, :, INPUT_INDEX["relay_on"]] = 1.0
            rows[:, :, INPUT_INDEX["relay_fast"]] = float(fast)
            rows[:, :, INPUT_INDEX["screen"]] = float(wet)
            for case, (volts, brake) in enumerate(cases):
                rows[case, :, INPUT_INDEX["supply_v"]] = volts
                rows[case, :, INPUT_INDEX["brake_torque_n_m"]] = brake
            physical, ours = both(bench, networks, rows)
            errors = np.sqrt(np.mean((ours[:, :, 0] - physical[:, :, 0]) ** 2, axis=1))
            errors[physical[:, -1, 1] < 0.2] = np.nan
            found[f"{brush}, {screen}"] = errors.reshape(len(supplies), len(brakes))
    return Grid(supplies, brakes, found)
