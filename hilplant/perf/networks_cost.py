"""What a minute costs with networks in place of load and motor, against the same in C."""

import time
from statistics import median

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench, load_bench
from hilplant.models.narx import NETWORK
from hilplant.models.plant import simulate_rows
from hilplant.perf.c_step import SimulateRows, compile_step
from hilplant.perf.minute import mixed_minute
from hilplant.perf.results import Goal, NotMeasurable, PartResult, Row
from hilplant.perf.samples import alternate
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, OUTPUTS

#: By bench: name of the row, goal [ms], what the thesis needed [s] (sections 6.2.1 and 6.4.3).
_BENCHES = {"network": ("hybrid", 20.0, 5.92), "networks": ("all networks", 30.0, 2.17)}
_RATIO_GOAL = 1.2
_ROUNDS = 30


def calm_minute(bench: Bench) -> Floats:
    """Return the inputs of the mixed minute without wind, on a screen that is dry or wet, as networks know it."""
    rows = mixed_minute().input_rows(bench.input_row, bench.step_ns)
    rows[:, INPUT_INDEX["vehicle_speed_m_s"]] = 0.0
    screen = rows[:, INPUT_INDEX["screen"]]
    screen[:] = np.round(screen)
    return rows


def measure() -> PartResult:
    """Run a calm minute with each kind of network, in turn by both languages; start-up apart."""
    measured = PartResult()
    in_c = compile_step()
    for name in _BENCHES:
        _measure_bench(name, in_c, measured)
    return measured


def _measure_bench(name: str, in_c: SimulateRows, measured: PartResult) -> None:
    label, goal_ms, thesis_s = _BENCHES[name]
    bench = load_bench(name)
    inputs = calm_minute(bench)
    ours, theirs = np.empty((2, len(inputs), len(OUTPUTS)))

    def timed_s(way: SimulateRows, outputs: Floats) -> float:
        state, begin = bench.state_row.copy(), time.perf_counter()
        way(state, inputs, bench.parameter_row, bench.tables, outputs)
        return time.perf_counter() - begin

    timed_s(simulate_rows, ours)
    timed_s(in_c, theirs)
    apart = float((np.abs(ours - theirs) / np.maximum(np.abs(ours).max(axis=0), 1e-300)).max())
    if not apart < 1e-6:
        raise NotMeasurable(f"the step in C is another one: outputs differ by {apart:.1g} of their size")
    seconds = alternate(_ROUNDS, lambda: timed_s(simulate_rows, ours), lambda: timed_s(in_c, theirs))
    ours_s, c_s = (median(values) for values in seconds)
    best_s, c_best_s = (min(values) for values in seconds)
    key = label.replace(" ", "_")
    measured.rows += [
        Row(f"60 s, {label}", ours_s * 1e3, "ms", c_s * 1e3, "C", Goal(goal_ms, of_ratio=False)),
        Row(f"60 s, {label}", ours_s * 1e3, "ms", c_s * 1e3, "C", Goal(_RATIO_GOAL)),
        Row(f"60 s, {label}, best round", best_s * 1e3, "ms", c_best_s * 1e3, "C"),
    ]
    measured.figures |= {
        f"simulate_60s_{key}_s": ours_s,
        f"simulate_60s_{key}_c_s": c_s,
        f"simulate_60s_{key}_ratio_to_c": ours_s / c_s,
        f"simulate_60s_{key}_best_s": best_s,
        f"simulate_60s_{key}_best_ratio_to_c": best_s / c_best_s,
    }
    shares = {mode: float((ours[:, OUTPUT_INDEX[f"{mode}_mode"]] == NETWORK).mean()) for mode in ("load", "motor")}
    said = "equal to the last bit" if apart == 0.0 else f"apart by {apart:.1g} of their size"
    measured.remarks.append(
        f"{label}: {thesis_s / ours_s:.0f} times as fast as the thesis' {thesis_s:g} s; networks active for the load "
        f"in {100.0 * shares['load']:.0f} %, of the motor in {100.0 * shares['motor']:.0f} % of the ticks; C {said}"
    )
