"""What one step of the plant costs in compiled Python, against the same step in C."""

import platform
import time
from statistics import median

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.models.plant import simulate_rows
from hilplant.perf.c_step import FLAGS, SimulateRows, compile_step, compiler
from hilplant.perf.minute import RATIO_GOALS, bench_with, mixed_minute
from hilplant.perf.results import Goal, NotMeasurable, PartResult, Row
from hilplant.perf.samples import alternate
from hilplant.signals import OUTPUTS
from hilplant.units import SECOND_NS

_ROUNDS = 30
_NATIVE = "-march=native"


def measure() -> PartResult:
    """Run the same minute in turn by both, and by C with all that this processor offers, under each load."""
    measured = PartResult()
    ways = [simulate_rows, compile_step(), compile_step(_NATIVE)]
    differences = [_measure_load(load, ways, measured) for load in RATIO_GOALS]
    measured.figures |= _of_the_default_bench(measured.figures)
    measured.figures["step_c_compiler"] = f"{compiler()} {' '.join(FLAGS)} ({platform.machine()})"
    said = "equal to the last bit" if max(differences) == 0.0 else f"apart by {max(differences):.1g} of their size"
    measured.remarks.append(f"C: {compiler()} {' '.join(FLAGS)}; outputs {said}")
    return measured


def _measure_load(load: str, ways: list[SimulateRows], measured: PartResult) -> float:
    """Add rows and figures of one load; return how far the outputs of the ways are apart."""
    bench = bench_with(load)
    inputs = mixed_minute().input_rows(bench.input_row, bench.step_ns)
    differences = _differences(bench, inputs, ways)
    outputs = np.empty((len(inputs), len(OUTPUTS)))
    seconds = alternate(_ROUNDS, *(lambda way=way: timed_s(way, bench, inputs, outputs) for way in ways))
    step_ns, c_ns, native_ns = (median(values) / len(inputs) * SECOND_NS for values in seconds)
    least_ns, c_least_ns, _ = (min(values) / len(inputs) * SECOND_NS for values in seconds)
    measured.rows += [
        Row(f"{load} load, median", step_ns, "ns", c_ns, "C", Goal(RATIO_GOALS[load])),
        Row(f"{load} load, best round", least_ns, "ns", c_least_ns, "C"),
        Row(f"{load} load, median", step_ns, "ns", native_ns, f"C {_NATIVE}"),
    ]
    measured.figures |= {
        f"step_{load}_ns": step_ns,
        f"step_{load}_c_ns": c_ns,
        f"step_{load}_c_native_ns": native_ns,
        f"step_{load}_ratio_to_c": step_ns / c_ns,
        f"step_{load}_best_ratio_to_c": least_ns / c_least_ns,
    }
    return differences


def _of_the_default_bench(figures: dict[str, float | str]) -> dict[str, float | str]:
    """Return the figures of the reduced load, which is that of the default bench, by their short names too."""
    return {
        name.replace("_reduced", ""): figure for name, figure in figures.items() if name.startswith("step_reduced_")
    }


def timed_s(way: SimulateRows, bench: Bench, inputs: Floats, outputs: Floats) -> float:
    """Return how long one run over all rows of inputs takes [s]."""
    state = bench.state_row.copy()
    begin = time.perf_counter()
    way(state, inputs, bench.parameter_row, bench.tables, outputs)
    return time.perf_counter() - begin


def _differences(bench: Bench, inputs: Floats, ways: list[SimulateRows]) -> float:
    """Check that all ways compute the same, and compile what is not yet; return the worst difference."""
    results = [np.empty((len(inputs), len(OUTPUTS))) for _ in ways]
    for way, outputs in zip(ways, results, strict=True):
        timed_s(way, bench, inputs, outputs)
    return worst_difference(results)


def worst_difference(results: list[Floats]) -> float:
    """Return by how much of their size outputs [..., outputs] are apart at most; refuse more than rounding.

    Raises
    ------
    NotMeasurable
        When one of the ways is another step: its time would be no yardstick.

    """
    size = np.maximum(np.abs(results[0]).reshape(-1, results[0].shape[-1]).max(axis=0), 1e-300)
    worst = max(float((np.abs(other - results[0]) / size).max()) for other in results[1:])
    if not worst < 1e-6:
        raise NotMeasurable(f"the step in C is another one: outputs differ by {worst:.1g} of their size")
    return worst
