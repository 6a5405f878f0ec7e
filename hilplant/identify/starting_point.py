"""What is known before the search: the motor by stage 1, all the rest by the bench."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.identify.first_stage import ModeResult, first_stage
from hilplant.identify.parameters import Choice
from hilplant.measurements.measurement import Measurement
from hilplant.motor_bench.bench_measurements import quantity


class StartingPoint(NamedTuple):
    """Values about which the search space is laid by (5.22), what stage 1 itself found, and how it went."""

    values: Floats
    first_stage: dict[str, float]
    notes: tuple[str, ...]


def starting_point(measurements: Sequence[Measurement], choice: Choice, gear_ratio: float) -> StartingPoint:
    """Ask stage 1 about each mode; where it cannot say, and for friction and force, the bench says what is known.

    Stage 1 does not tell the damping from the load, so nothing is taken as known of it.
    """
    found: dict[str, ModeResult] = {}
    notes: list[str] = []
    for data in measurements:
        try:
            results = first_stage(data, gear_ratio)
        except Failure as error:
            notes.append(f"stage 1: {error}")
            continue
        notes += [f"stage 1: {data.source}, {mode} mode: {text}" for mode, text in results.failures.items()]
        found |= {mode: result for mode, result in results.items() if mode not in found}
    motor = _motor(found)
    for mode, each in found.items():
        left_out = f" ({each.left_out})" if each.left_out else ""
        notes.append(f"stage 1, {mode}: {each.steps} steps of the voltage, {each.turns} turns{left_out}")
    values = choice.values
    for index, name in enumerate(choice.names):
        values[index] = motor.get(name, 0.0 if name == "damping_n_m_s" and motor else values[index])
    missing = [name for name in choice.names if name.endswith(("_ohm", "_henry", "_v_s")) and name not in motor]
    if missing:
        notes.append(f"the search begins about the bench's own {', '.join(missing)}")
    return StartingPoint(values, motor, tuple(notes))


def _motor(found: dict[str, ModeResult]) -> dict[str, float]:
    """Return motor parameters by name; the inertia is the mean of both modes."""
    motor: dict[str, float] = {}
    inertias = []
    for mode, result in found.items():
        equivalent = result.by_park or result.by_load
        numbers = [float(quantity(value).nominal_value) for value in equivalent]
        for part, number in zip(("resistance_ohm", "inductance_henry", "constant_v_s"), numbers, strict=False):
            motor[f"{mode}_{part}"] = number
        inertias.append(numbers[3])
    if inertias:
        motor["inertia_kg_m2"] = float(np.mean(inertias))
    return motor
