"""What one step of the plant costs in compiled Python, against the same step by hand in C."""

import platform
import time
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import numpy as np

from hilplant.bench import Bench, load_bench
from hilplant.benchmarks.c_step import FLAGS, Rows, SimulateRows, compile_step, compiler
from hilplant.benchmarks.results import Goal, Measured, NotMeasurable, Row
from hilplant.benchmarks.samples import alternate
from hilplant.models.plant import simulate_rows
from hilplant.scenario import Entry, Scenario
from hilplant.signals import INPUT_INDEX, OUTPUTS
from hilplant.units import SECOND_NS

_ROUNDS = 40
_GOAL = Goal(1.15)
_NATIVE = "-march=native"


def mixed_minute() -> Scenario:
    """Return 60 s of a wiper's life: at rest, slow, a brown-out, fast, off, and all of it again."""
    on = [(1.0, 1.0), (26.0, 0.0), (30.0, 1.0), (44.0, 0.0), (46.0, 1.0), (58.0, 0.0)]
    fast = [(14.0, 1.0), (26.0, 0.0), (34.0, 1.0), (44.0, 0.0)]
    supply = [Entry(8.0, 9.0, 0.5), Entry(10.0, 13.5, 0.5)]
    return Scenario(60.0, {}, {
        INPUT_INDEX["relay_on"]: tuple(Entry(*pair) for pair in on),
        INPUT_INDEX["relay_fast"]: tuple(Entry(*pair) for pair in fast),
        INPUT_INDEX["supply_v"]: tuple(supply),
    })  # fmt: skip


def measure() -> Measured:
    """Run the same minute in turn by both, and by C with all that this processor offers."""
    bench = load_bench("default")
    inputs = mixed_minute().input_rows(bench.input_row, bench.step_ns)
    outputs = np.empty((len(inputs), len(OUTPUTS)))
    with TemporaryDirectory(prefix="hilplant-c-") as folder:
        ways = [simulate_rows, compile_step(Path(folder)), compile_step(Path(folder), _NATIVE)]
        differences = _differences(bench, inputs, ways)
        seconds = alternate(_ROUNDS, *(lambda way=way: timed_s(way, bench, inputs, outputs) for way in ways))
    step_ns, c_ns, native_ns = (median(values) / len(inputs) * SECOND_NS for values in seconds)
    least_ns, c_least_ns, _ = (min(values) / len(inputs) * SECOND_NS for values in seconds)
    rows = [
        Row("a step, median of rounds", step_ns, "ns", c_ns, "C", _GOAL),
        Row("a step, best round", least_ns, "ns", c_least_ns, "C"),
        Row("a step, median of rounds", step_ns, "ns", native_ns, f"C {_NATIVE}"),
    ]
    figures: dict[str, float | str] = {
        "step_ns": step_ns,
        "step_c_ns": c_ns,
        "step_c_native_ns": native_ns,
        "step_ratio_to_c": step_ns / c_ns,
        "step_best_ratio_to_c": least_ns / c_least_ns,
        "step_c_compiler": f"{compiler()} {' '.join(FLAGS)} ({platform.machine()})",
    }
    remark = f"C: {compiler()} {' '.join(FLAGS)}; outputs differ by {differences:.1g} of their size at most"
    return Measured(rows, figures, [remark])


def timed_s(way: SimulateRows, bench: Bench, inputs: Rows, outputs: Rows) -> float:
    """Return how long one run over all rows of inputs takes [s]."""
    state = bench.state_row.copy()
    begin = time.perf_counter()
    way(state, inputs, bench.parameter_row, bench.tables, outputs)
    return time.perf_counter() - begin


def _differences(bench: Bench, inputs: Rows, ways: list[SimulateRows]) -> float:
    """Check that all ways compute the same, and compile what is not yet; return the worst difference."""
    results = [np.empty((len(inputs), len(OUTPUTS))) for _ in ways]
    for way, outputs in zip(ways, results, strict=True):
        timed_s(way, bench, inputs, outputs)
    size = np.maximum(np.abs(results[0]).max(axis=0), 1e-300)
    worst = max(float((np.abs(other - results[0]) / size).max()) for other in results[1:])
    if not worst < 1e-6:
        raise NotMeasurable(f"the step in C is another one: outputs differ by {worst:.1g} of their size")
    return worst
