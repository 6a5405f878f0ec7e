"""Twin data: a bench's own plant plays a test, and its signals are corrupted as a rig corrupts them.

The true parameters are known, so whatever identification says can be held against them.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.identify.sequence import OFF, SequenceStage, play
from hilplant.measurements.measurement import Measurement
from hilplant.models.plant import tick
from hilplant.models.records import STATE_INDEX
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, OUTPUTS
from hilplant.units import SECOND_NS, TURN_RAD

#: A voltage is switched off this long after its park edge, at most [s].
LATEST_OFF_S = 0.02


class Corruption(NamedTuple):
    """What corrupts the signals.

    Current: white noise of this standard deviation and steps of this size. Supply: a ripple that the motor sees and the
    voltmeter too; what the voltmeter adds is noise of its own. Park: each edge comes early or late by up to
    `park_jitter_s`. A part of the samples is missing, in gaps of `gap_s`.
    """

    current_a: float = 0.1
    quantum_a: float = 0.01
    ripple_v: float = 0.0
    ripple_hz: float = 87.0
    voltmeter_v: float = 0.0
    park_jitter_s: float = 0.0
    missing_part: float = 0.0
    gap_s: float = 0.02


CLEAN = Corruption(0.0, 0.0)


class TwinCondition(NamedTuple):
    """One recording: mode and screen throughout, each voltage from rest for one turn."""

    fast: bool
    screen: float
    voltages_v: tuple[float, ...]
    turns: int = 1


def thesis_conditions(voltages_v: Sequence[float]) -> list[TwinCondition]:
    """Return slow and dry, fast and wet, as in 5.5.2."""
    return [TwinCondition(False, 0.0, tuple(voltages_v)), TwinCondition(True, 1.0, tuple(voltages_v))]


class Chance(NamedTuple):
    """What no two recordings of a condition share.

    The angle between crank and park angle at the start [rad], and how long after its park edge each voltage is switched
    off [s]. So the crank starts each time from another angle, and the rounding of the park edges is another one too.
    """

    start_rad: float
    late_s: tuple[float, ...]


def stages(condition: TwinCondition, late_s: Sequence[float] = ()) -> list[SequenceStage]:
    """Return the test: each voltage is switched on at rest, and off at a park edge or so much later."""
    off = OFF._replace(longest_s=0.3, fast=condition.fast)
    parts = [off]
    for index, volts in enumerate(condition.voltages_v):
        on = SequenceStage(True, condition.fast, volts, condition.turns, 20.0)
        parts += [on, *(on._replace(edges=0, longest_s=late) for late in late_s[index : index + 1]), off]
    return parts


class Clean(NamedTuple):
    """What the plant did: its inputs and outputs, a row for each tick."""

    inputs: Floats
    outputs: Floats


def chance(bench: Bench, condition: TwinCondition, seed: int) -> Chance:
    """Draw where the crank rests within the park window, and how late each voltage is switched off."""
    random = np.random.default_rng([seed, 21])
    reach = bench.parameters.park_switch.half_window_rad
    late = random.uniform(0.0, LATEST_OFF_S, len(condition.voltages_v))
    return Chance(float(random.uniform(-reach, reach)), tuple(late.tolist()))


def played(bench: Bench, condition: TwinCondition, ripple: Corruption = CLEAN, drawn: Chance | None = None) -> Clean:
    """Play a condition with a bench's plant; with nothing drawn, from the bench's own start."""
    state, inputs, outputs = bench.state_row.copy(), bench.input_row.copy(), np.zeros(len(OUTPUTS))
    if drawn is not None:
        angle = bench.parameters.park_switch.angle_rad + drawn.start_rad
        state[STATE_INDEX["crank_angle_rad"]] = angle % TURN_RAD
    rows: list[Floats] = []
    made: list[Floats] = []
    inputs[INPUT_INDEX["screen"]] = condition.screen
    step_s = bench.step_ns / SECOND_NS

    def contact_after(stage: SequenceStage) -> bool:
        swing = ripple.ripple_v * np.sin(2.0 * np.pi * ripple.ripple_hz * len(rows) * step_s)
        inputs[INPUT_INDEX["relay_on"]], inputs[INPUT_INDEX["relay_fast"]] = stage.on, stage.fast
        inputs[INPUT_INDEX["supply_v"]] = max(0.0, stage.voltage_v + swing)
        tick(state, inputs, bench.parameter_row, bench.tables, outputs)
        rows.append(inputs.copy())
        made.append(outputs.copy())
        return bool(outputs[OUTPUT_INDEX["park_contact"]] > 0.5)

    play(stages(condition, drawn.late_s if drawn else ()), step_s, contact_after)
    return Clean(np.array(rows), np.array(made))


def recorded(bench: Bench, condition: TwinCondition, how: Corruption, seed: int) -> Measurement:
    """Play a condition as a rig would have recorded it: start, switching and noise are this seed's own."""
    clean = played(bench, condition, how, chance(bench, condition, seed))
    return corrupted(clean, how, bench.step_ns / SECOND_NS, seed)


def corrupted(clean: Clean, how: Corruption, step_s: float, seed: int) -> Measurement:
    """Return what a rig would have recorded."""
    random = np.random.default_rng(seed)
    outputs = {name: clean.outputs[:, index] for name, index in OUTPUT_INDEX.items()}
    count = len(clean.outputs)
    current = outputs["current_a"] + how.current_a * random.standard_normal(count)
    if how.quantum_a > 0.0:
        current = how.quantum_a * np.round(current / how.quantum_a)
    voltage = outputs["terminal_v"] + how.voltmeter_v * random.standard_normal(count)
    park = _jittered(outputs["park_contact"], how.park_jitter_s / step_s, random)
    valid = np.ones(count, dtype=np.bool_)
    length = max(1, round(how.gap_s / step_s))
    for _ in range(round(how.missing_part * count / length)):
        begin = int(random.integers(0, count - length))
        valid[begin : begin + length] = False
    fast = clean.inputs[:, INPUT_INDEX["relay_fast"]].copy()
    for values in (voltage, current):
        values[~valid] = np.interp(np.flatnonzero(~valid), np.flatnonzero(valid), values[valid])
    time_s = np.asarray(np.arange(count) * step_s, np.float64)
    return Measurement(time_s, voltage, current, park, fast, valid, step_s, source="twin")


def _jittered(contact: Floats, most: float, random: np.random.Generator) -> Floats:
    """Move each edge by up to `most` samples either way."""
    if most <= 0.0:
        return contact.copy()
    edges = np.flatnonzero(np.diff(contact)) + 1
    moved = np.clip(edges + np.round(random.uniform(-most, most, len(edges))).astype(int), 1, len(contact) - 1)
    made = np.full(len(contact), contact[0])
    for index, edge in enumerate(moved):
        made[edge:] = contact[edges[index]]
    return made


def write_csv(path: Path, data: Measurement) -> None:
    """Write the measurement as a rig's logger would; samples that are missing are not there."""
    columns = {
        "time_s": data.time_s, "voltage_v": data.voltage_v, "current_a": data.current_a,
        "park_contact": data.park, "relay_fast": data.fast,
    }  # fmt: skip
    table = np.column_stack(list(columns.values()))[data.valid]
    np.savetxt(path, table, fmt="%.9g", delimiter=",", header=",".join(columns), comments="")
