"""How many steps a second a batch of 1000 parameter sets takes on all processors, beside C with OpenMP."""

import os
import time
from collections.abc import Callable
from statistics import median

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.models.row import pack
from hilplant.perf.c_step import SimulateRows, compile_batch
from hilplant.perf.minute import bench_with, mixed_minute
from hilplant.perf.results import Goal, PartResult, Row
from hilplant.perf.samples import alternate
from hilplant.perf.step_cost import worst_difference
from hilplant.signals import OUTPUT_INDEX
from hilplant.simulation.batch import simulate_batch

SETS = 1000
_TICKS = slice(11_000, 13_000)
_ROUNDS = 9
_GOAL = Goal(1.2)
_COLUMNS = ("current_a", "motor_speed_rad_s", "crank_angle_rad")


def measure() -> PartResult:
    """Run the sets by one call of each, in turn: two seconds of slow wiping, from rest on a screen that gets wet."""
    bench = bench_with("reduced")
    inputs = mixed_minute().input_rows(bench.input_row, bench.step_ns)[_TICKS]
    parameters = shaken_sets(bench, SETS)
    ways = [_ours, compile_batch([OUTPUT_INDEX[name] for name in _COLUMNS])]
    results = [np.empty((SETS, len(inputs), len(_COLUMNS))) for _ in ways]
    jobs = [_job(way, bench, inputs, parameters, result) for way, result in zip(ways, results, strict=True)]
    for job in jobs:
        job()
    differences = worst_difference(results)
    ours, limits = alternate(_ROUNDS, *jobs)
    million = SETS * len(inputs) / 1e6
    ours_ns, limit_ns = median(ours) * 1e3 / million, median(limits) * 1e3 / million
    processors = len(os.sched_getaffinity(0))
    row = Row(f"{SETS} sets, {processors} cores, a step", ours_ns, "ns", limit_ns, "C, OpenMP", _GOAL)
    figures: dict[str, float | str] = {
        "batch_steps_per_s": 1e9 / ours_ns,
        "batch_c_steps_per_s": 1e9 / limit_ns,
        "batch_ratio_to_c": ours_ns / limit_ns,
        "batch_sets": SETS,
        "batch_cores": processors,
    }
    remark = f"{1e3 / ours_ns:.1f} million steps a second, C {1e3 / limit_ns:.1f}; apart by {differences:.1g}"
    return PartResult([row], figures, [remark])


def shaken_sets(bench: Bench, sets: int) -> Floats:
    """Return rows of parameters near those of the bench: other motors, other blades."""
    random = np.random.default_rng(7)
    rows = []
    for wear, force, inertia, resistance in random.uniform(0.7, 1.3, (sets, 4)):
        load, motor = bench.parameters.load, bench.parameters.motor
        left, right = (blade._replace(force_n=blade.force_n * force) for blade in (load.left_blade, load.right_blade))
        load = load._replace(left_blade=left._replace(wear=wear), right_blade=right)
        slow = motor.slow._replace(resistance_ohm=motor.slow.resistance_ohm * resistance)
        motor = motor._replace(slow=slow, inertia_kg_m2=motor.inertia_kg_m2 * inertia)
        rows.append(pack(bench.parameters._replace(load=load, motor=motor)))
    return np.array(rows)


def _ours(states: Floats, inputs: Floats, parameters: Floats, tables: Floats, outputs: Floats) -> None:
    simulate_batch(states, inputs, parameters, tables, _COLUMNS, outputs)


def _job(way: SimulateRows, bench: Bench, inputs: Floats, parameters: Floats, outputs: Floats) -> Callable[[], float]:
    def job() -> float:
        states = np.tile(bench.state_row, (len(parameters), 1))
        begin = time.perf_counter()
        way(states, inputs, parameters, bench.tables, outputs)
        return time.perf_counter() - begin

    return job
