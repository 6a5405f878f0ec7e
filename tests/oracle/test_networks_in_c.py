"""The step with networks in C and the compiled Python give the same bits, through every hand-over."""

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.models.plant import simulate_rows
from hilplant.perf.c_step import compile_step
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, OUTPUTS
from hilplant.train.motor_data import excitation


@pytest.mark.parametrize("name", ["default", "polynomial", "network", "networks"])
def test_both_go_alike_through_mixed_scenarios_with_faults(name: str) -> None:
    bench, random = load_bench(name), np.random.default_rng(8)
    rows = np.concatenate([excitation(bench, brush, 4.0, random) for brush in ("slow", "fast", "slow", "fast")])
    screen, brake = rows[:, INPUT_INDEX["screen"]], rows[:, INPUT_INDEX["brake_torque_n_m"]]
    screen[6000:], brake[9000:] = np.round(screen[6000:]), 0.0
    rows[12_000:13_000, INPUT_INDEX["supply_v"]] += 10.0
    rows[-500, INPUT_INDEX["supply_v"]] = np.nan
    ours, theirs = np.empty((2, len(rows), len(OUTPUTS)))
    states = [bench.state_row.copy(), bench.state_row.copy()]
    simulate_rows(states[0], rows, bench.parameter_row, bench.tables, ours)
    compile_step()(states[1], rows, bench.parameter_row, bench.tables, theirs)
    if name == "networks":
        assert set(np.unique(ours[:-500, OUTPUT_INDEX["motor_mode"]])) == {1.0, 2.0, 3.0}
        assert {1.0, 3.0} <= set(np.unique(ours[:-500, OUTPUT_INDEX["load_mode"]]))
    assert ours[-1, OUTPUT_INDEX["guard"]] == 1.0
    assert ours.tobytes() == theirs.tobytes()
    assert states[0].tobytes() == states[1].tobytes()
