"""How long 60 simulated seconds take by `hilplant.simulate`; the thesis' 4 s are in its section 6.3."""

import time
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import numpy as np

from hilplant.bench import load_bench
from hilplant.benchmarks.c_step import compile_step
from hilplant.benchmarks.results import Goal, Measured, Row
from hilplant.benchmarks.samples import alternate
from hilplant.benchmarks.step_cost import mixed_minute, timed_s
from hilplant.signals import OUTPUTS
from hilplant.simulation import simulate

_ROUNDS = 20
_GOAL_MS = Goal(20.0, of_ratio=False)
_THESIS_S = 4.0


def measure() -> Measured:
    """Simulate a minute, inputs and results included; start-up and loading of the files apart."""
    bench, scenario = load_bench("default"), mixed_minute()
    inputs = scenario.input_rows(bench.input_row, bench.step_ns)
    outputs = np.empty((len(inputs), len(OUTPUTS)))

    def by_simulate() -> float:
        begin = time.perf_counter()
        simulate(bench, scenario)
        return time.perf_counter() - begin

    with TemporaryDirectory(prefix="hilplant-c-") as folder:
        in_c = compile_step(Path(folder))
        by_simulate()
        ours, limits = alternate(_ROUNDS, by_simulate, lambda: timed_s(in_c, bench, inputs, outputs))
    ours_s, limit_s = median(ours), median(limits)
    rows = [Row("60 simulated seconds", ours_s * 1e3, "ms", limit_s * 1e3, "C, steps alone", _GOAL_MS)]
    figures: dict[str, float | str] = {
        "simulate_60s_s": ours_s,
        "simulate_60s_c_s": limit_s,
        "simulate_60s_ratio_to_c": ours_s / limit_s,
    }
    remark = f"{_THESIS_S / ours_s:.0f} times as fast as the thesis' {_THESIS_S:g} s for 60 s (section 6.3)"
    return Measured(rows, figures, [remark])
