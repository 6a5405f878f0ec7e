"""How long 60 simulated seconds take by `hilplant.simulate`, beside the times of section 6.3 of Dooner (2016)."""

import time
from statistics import median

import numpy as np

from hilplant.bench import Bench
from hilplant.perf.c_step import SimulateRows, compile_step
from hilplant.perf.minute import MINUTE_GOALS_MS, THESIS_S, bench_with, mixed_minute
from hilplant.perf.results import Goal, PartResult, Row
from hilplant.perf.samples import alternate
from hilplant.perf.step_cost import timed_s
from hilplant.signals import OUTPUTS
from hilplant.simulation.run import simulate

_ROUNDS = 20


def measure() -> PartResult:
    """Simulate a minute under each load, inputs and results included; start-up and loading of the files apart."""
    measured = PartResult()
    in_c = compile_step()
    for load, goal_ms in MINUTE_GOALS_MS.items():
        ours_s, limit_s = _minutes_s(bench_with(load), in_c)
        goal = Goal(goal_ms, of_ratio=False)
        measured.rows.append(Row(f"60 s, {load} load", ours_s * 1e3, "ms", limit_s * 1e3, "C, steps alone", goal))
        measured.figures |= {f"simulate_60s_{load}_s": ours_s, f"simulate_60s_{load}_c_s": limit_s}
        measured.remarks.append(
            f"{load} load: {THESIS_S[load] / ours_s:.0f} times as fast as the thesis' {THESIS_S[load]:g} s"
        )
    ours, limit = (measured.figures[name] for name in ("simulate_60s_reduced_s", "simulate_60s_reduced_c_s"))
    ratio = float(ours) / float(limit)
    measured.figures |= {"simulate_60s_s": ours, "simulate_60s_c_s": limit, "simulate_60s_ratio_to_c": ratio}
    return measured


def _minutes_s(bench: Bench, in_c: SimulateRows) -> tuple[float, float]:
    """Return how long a minute takes by `simulate`, and in C [s]."""
    scenario = mixed_minute()
    inputs = scenario.input_rows(bench.input_row, bench.step_ns)
    outputs = np.empty((len(inputs), len(OUTPUTS)))

    def by_simulate() -> float:
        begin = time.perf_counter()
        simulate(bench, scenario)
        return time.perf_counter() - begin

    by_simulate()
    ours, limits = alternate(_ROUNDS, by_simulate, lambda: timed_s(in_c, bench, inputs, outputs))
    return median(ours), median(limits)
