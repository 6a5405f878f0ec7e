"""The current that counts as a warm motor's stall never flows as long without a break in a wiper that runs."""

import numpy as np
import pytest

from hilplant.arrays import Floats
from hilplant.bench import load_bench
from hilplant.ecu.settings import controller_settings
from hilplant.signals import INPUT_INDEX
from hilplant.simulation.batch import simulate_batch
from hilplant.units import TURN_RAD

#: One of each kind of plant that is shipped.
WIPERS = ("default", "depressed", "network", "networks", "production_car", "warm_motor")
#: A wiper that does not make a whole turn in so many ticks at the end is stalled, and none of these.
LAST = 5000
VOLTS, SCREENS, SECONDS = np.arange(9.0, 16.1, 1.0), (0.0, 0.5, 1.0), 16


def longest_s(name: str, limit_a: float) -> float:
    """Return for how long at most more flows without a break.

    From 9 to 16 V, dry, tacky and wet, slow and fast, from the start on.
    """
    bench = load_bench(name)
    cases = [(volts, screen, fast) for volts in VOLTS for screen in SCREENS for fast in (0.0, 1.0)]
    inputs = np.tile(bench.input_row, (len(cases), SECONDS * 1000, 1))
    for rows, values in zip(inputs, cases, strict=True):
        for column, value in zip(("supply_v", "screen", "relay_fast", "relay_on"), (*values, 1.0), strict=True):
            rows[:, INPUT_INDEX[column]] = value
    states = np.tile(bench.state_row, (len(cases), 1))
    parameters = np.tile(bench.parameter_row, (len(cases), 1))
    found = simulate_batch(states, inputs, parameters, bench.tables, ["current_a", "crank_angle_rad"])
    runs = [np.ptp(np.unwrap(case[-LAST:, 1])) > TURN_RAD for case in found]
    longest = [
        longest_run(np.abs(case[:, 0]) > limit_a) * bench.step_ns * 1e-9 if running else 0.0
        for case, running in zip(found, runs, strict=True)
    ]
    worst = int(np.argmax(longest))
    print(
        f"{name}: {sum(runs)} of {len(cases)} run, at most {longest[worst]:.3f} s, at {cases[worst]} (V, screen, fast)"
    )
    return float(longest[worst])


def longest_run(above: Floats) -> int:
    """Return how many ticks in a row are above."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], above, [False]]).astype(int)))
    return int((edges[1::2] - edges[::2]).max(initial=0))


@pytest.mark.parametrize("name", WIPERS)
def test_a_running_wiper_is_not_taken_for_a_stalled_one(name: str) -> None:
    settings = controller_settings(load_bench(name).ecu)
    assert longest_s(name, settings.warm_stall_current_a) < 0.8 * settings.warm_stall_s
