"""What one evaluation of the torque network costs in compiled Python, against the same in C."""

import time
from statistics import median

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import load_bench
from hilplant.models.torque_samples import network_tangents
from hilplant.perf.c_step import Tangents, compile_network
from hilplant.perf.results import Goal, PartResult, Row
from hilplant.perf.samples import alternate
from hilplant.units import SECOND_NS, TURN_RAD

_ROUNDS, _SAMPLES = 40, 20_000
_GOAL = Goal(1.2)


def measure() -> PartResult:
    """Evaluate random states in turn by both."""
    bench = load_bench("network")
    numbers, random = np.ascontiguousarray(bench.parameters.networks), np.random.default_rng(1)
    states = np.column_stack([random.uniform(0.0, TURN_RAD, _SAMPLES), random.uniform(1.0, 7.0, _SAMPLES)])
    into = np.empty((_SAMPLES, 3))
    ways = (network_tangents, compile_network())
    seconds = alternate(_ROUNDS, *(lambda way=way: _timed_s(way, numbers, states, into) for way in ways))
    ours_ns, c_ns = (median(values) / _SAMPLES * SECOND_NS for values in seconds)
    rows = [
        Row("torque network", ours_ns, "ns", c_ns, "C", _GOAL),
    ]
    figures: dict[str, float | str] = {
        "torque_network_ns": ours_ns,
        "torque_network_c_ns": c_ns,
        "torque_network_ratio_to_c": ours_ns / c_ns,
    }
    return PartResult(rows, figures)


def _timed_s(way: Tangents, numbers: Floats, states: Floats, into: Floats) -> float:
    begin = time.perf_counter()
    way(numbers, False, states, into)
    return time.perf_counter() - begin
