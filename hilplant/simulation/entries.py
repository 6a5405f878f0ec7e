"""What a scenario says of one input over time: entries, each a value, a ramp or a generator."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.durations import Seconds, SomeSeconds
from hilplant.bench.values import signal_value
from hilplant.checked_yaml.checked import Checked
from hilplant.checked_yaml.problems import suggestion
from hilplant.checked_yaml.reading import Reading
from hilplant.checked_yaml.yaml_reader import Document, Location
from hilplant.declaration import Signal
from hilplant.failure import Failure
from hilplant.signals import INPUT_INDEX, INPUTS
from hilplant.simulation.stimuli import GENERATORS, Generated, Shape
from hilplant.units import SECOND_NS


class _Ramp(Checked):
    ramp_to: Any
    seconds: SomeSeconds


class _Instant(Checked):
    time: Seconds


@dataclass(frozen=True, slots=True)
class Entry:
    """From `time_s` on the signal has `value`, or is on its way there for `ramp_s`; `place` is its file and line.

    Where there is a `shape` that gives the values, by time from there on.
    """

    time_s: float
    value: float
    ramp_s: float = 0.0
    place: str = field(default="", kw_only=True)
    shape: Shape | None = field(default=None, kw_only=True)


def read_entries(reading: Reading, document: Document, signals: dict[str, Any]) -> dict[int, tuple[Entry, ...]]:
    """Return the entries of each input by its index; `signals` are the pairs as they are written."""
    found: dict[int, tuple[Entry, ...]] = {}
    for name, items in signals.items():
        if name not in INPUT_INDEX:
            text = f"the plant has no input '{name}'{suggestion(name, INPUT_INDEX)}"
            reading.note(document, ("signals", name), text)
        elif isinstance(items, list):
            pairs = [pair if isinstance(pair, list) else [] for pair in items]
            signal = INPUTS[INPUT_INDEX[name]]
            found[INPUT_INDEX[name]] = _entries_of(reading, document, signal, pairs)
    return found


def _entries_of(reading: Reading, document: Document, signal: Signal, pairs: Sequence[list[Any]]) -> tuple[Entry, ...]:
    entries: list[Entry] = []
    for index, pair in enumerate(pairs):
        if len(pair) != 2:
            continue
        location = ("signals", signal.name, index)
        instant = reading.check(document, (*location, 0), {"time": pair[0]}, _Instant)
        entry = _entry(reading, document, (*location, 1), signal)
        if instant is None or entry is None:
            continue
        if entries and instant.time <= entries[-1].time_s:
            reading.note(document, location, f"time {instant.time} s must come after {entries[-1].time_s} s")
            continue
        value, ramp_s, shape = entry
        place = "{}:{}".format(*document.place(location))
        entries.append(Entry(instant.time, value, ramp_s, place=place, shape=shape))
    return tuple(entries)


def _generated(reading: Reading, document: Document, location: Location, signal: Signal) -> Shape | None:
    """Return what a generator makes; a mistake in it is told."""
    generator = reading.take(document, location, Generated)
    if generator is None:
        return None
    try:
        if signal.kind != "real":
            raise Failure(f"{signal.name} is a {signal.kind} and cannot follow a generator; give it a value")
        return generator.shape(Path(document.place(location)[0]).parent)
    except Failure as error:
        reading.note(document, location, str(error))
        return None


def _entry(
    reading: Reading, document: Document, location: Location, signal: Signal
) -> tuple[float, float, Shape | None] | None:
    """Return the written value, the time over which it is reached, or the generator in its place."""
    written, ramp_s = document.at(location), 0.0
    if isinstance(written, dict) and GENERATORS & set(written):
        shape = _generated(reading, document, location, signal)
        return None if shape is None else (0.0, 0.0, shape)
    if isinstance(written, dict):
        ramp = reading.take(document, location, _Ramp)
        if ramp is None:
            return None
        written, ramp_s = ramp.ramp_to, ramp.seconds
    try:
        if ramp_s and signal.kind != "real":
            raise ValueError(f"{signal.name} is a {signal.kind} and cannot follow a ramp; give it a value")
        value = signal_value(signal, written)
        name = _stands_for(signal, value)
        if ramp_s and name:
            raise ValueError(f"{signal.name} cannot ramp to '{name}'; ramp to a number from 0 on, then say '{name}'")
        return value, ramp_s, None
    except ValueError as error:
        reading.note(document, location, str(error))
        return None


def _stands_for(signal: Signal, value: float) -> str:
    """Return the name of a value that is no quantity, such as 'same', so that no ramp can lead to or from it."""
    return next((name for name, named in signal.names if value < 0.0 and named < 0.0), "")


def apply(column: Floats, entry: Entry, step_ns: int, signal: Signal) -> None:
    """Write one entry over what came before it in the column of its input."""
    first, ticks = (round(seconds * SECOND_NS / step_ns) for seconds in (entry.time_s, entry.ramp_s))
    if first >= len(column):
        return
    if entry.shape is not None:
        _follow_shape(column[first:], entry.shape, step_ns, (entry.place, signal))
        return
    name = _stands_for(signal, column[first])
    if ticks and name:
        text = f"{signal.name} is '{name}' when its ramp at {entry.time_s:g} s begins; give it a value before"
        raise Failure(": ".join(part for part in (entry.place, text) if part))
    ramp = np.linspace(column[first], entry.value, ticks, endpoint=False)[: len(column) - first]
    column[first:] = entry.value
    column[first : first + len(ramp)] = ramp


def _follow_shape(column: Floats, shape: Shape, step_ns: int, told: tuple[str, Signal]) -> None:
    """Write what a generator makes over a column; values out of the signal's range are refused."""
    values, (place, signal) = shape(np.arange(len(column), dtype=np.float64) * (step_ns / SECOND_NS)), told
    outside = (values < signal.minimum) | (values > signal.maximum)
    if outside.any():
        worst = values[np.argmax(outside)]
        limits = f"{signal.minimum:g} to {signal.maximum:g} {signal.unit}".rstrip()
        raise Failure(f"{place}: {signal.name} becomes {worst:g}, which is not within {limits}")
    column[:] = values
