"""From any state, with any inputs, a tick in C gives the compiled step's bits, on every bench that is shipped."""

import ctypes
from pathlib import Path

import numpy as np
import pytest
from support.random_ticks import by_ticks, random_inputs, random_states

from hilplant.bench import load_bench
from hilplant.perf.c_step import CompiledPlant, library
from hilplant.signals import OUTPUT_INDEX

BENCHES = sorted(path.stem for path in (Path(__file__).parents[2] / "config" / "benches").glob("*.yaml"))
TICKS = 4000


@pytest.mark.parametrize("name", BENCHES)
def test_a_tick_from_anywhere_is_the_same(name: str) -> None:
    bench, random = load_bench(name), np.random.default_rng(BENCHES.index(name))
    states, inputs = random_states(TICKS, random), random_inputs(bench, TICKS, random)
    plant = CompiledPlant.of(bench.parameter_row, bench.tables)
    ours, theirs = by_ticks(bench, states, inputs), by_ticks(bench, states, inputs, library(), ctypes.byref(plant))
    differing = np.flatnonzero((ours.view(np.int64) != theirs.view(np.int64)).any(axis=1))
    assert not differing.size, f"{differing.size} ticks, the first from {states[differing[0]]}, {inputs[differing[0]]}"
    guard, speed = ours[:, OUTPUT_INDEX["guard"]], ours[:, OUTPUT_INDEX["motor_speed_rad_s"]]
    assert {0.0, 1.0} <= set(guard)
    assert (speed < 0.0).any()
    if name == "networks":
        modes = [set(ours[:, OUTPUT_INDEX[column]]) for column in ("load_mode", "motor_mode")]
        assert modes == [{1.0, 2.0, 3.0}] * 2
