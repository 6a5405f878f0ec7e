"""A scenario file: what drives the plant over time, when nothing on a bus does."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, WithJsonSchema, field_validator

from hilplant import resources
from hilplant.arrays import Floats
from hilplant.bench.description import InitialSection
from hilplant.bench.durations import Seconds, SomeSeconds
from hilplant.bench.values import signal_value
from hilplant.checked_yaml.checked import Checked, wrong
from hilplant.checked_yaml.problems import suggestion
from hilplant.checked_yaml.reading import Reading
from hilplant.checked_yaml.yaml_reader import Document, Location
from hilplant.declaration import Signal
from hilplant.ecu.stalk import StalkTurn
from hilplant.failure import Failure
from hilplant.faults.written import SIGNALS, FaultEntry, Written
from hilplant.signals import INPUT_INDEX, INPUTS
from hilplant.simulation.scenario_schema import EntriesOfInputs
from hilplant.simulation.scenario_sections import read_expectations, read_stalk
from hilplant.simulation.stimuli import GENERATORS, Generated, Shape
from hilplant.units import SECOND_NS
from hilplant.verdicts.binding import Known, Placed, condition_of

#: Name of the value by which a signal takes that of another.
_SAME = "same"
#: Time 0 is the tick after the first in which no command is missing.
FIRST_COMMAND = "first command"
DEFAULT_START_S = 60.0

_Pair = Annotated[list[Any], Field(min_length=2, max_length=2)]


class ScenarioFile(Checked):
    """What drives the plant over time, and what is expected of it."""

    seconds: SomeSeconds = Field(description="length of the run", json_schema_extra={"x-unit": "s"})
    title: str = Field(default="", description="what the scenario is about")
    requirement: str = Field(default="", description="identifier of what it shows")
    bench: Annotated[str | None, Field(min_length=1)] = Field(default=None, description="bench it is meant for")
    initial: Annotated[dict[str, Any], WithJsonSchema(InitialSection.model_json_schema())] = Field(
        default={}, description="state at tick 0 where it differs from the bench's"
    )
    signals: Annotated[dict[str, list[_Pair]], EntriesOfInputs()] = Field(
        default={}, description="inputs of the plant: pairs of time [s] and value, which holds until the next"
    )
    stalk: list[_Pair] = Field(default=[], description="movements of the stalk: pairs of time [s] and movement")
    marks: dict[str, Seconds] = Field(default={}, description="times [s] with names")
    faults: list[FaultEntry] = Field(default=[], description="faults that are inserted; hilplant faults lists all")
    expect: list[dict[str, Any]] = Field(default=[], description="what is expected of the run")
    start: Literal["first tick", "first command"] | dict[str, Any] = Field(
        default="first tick",
        description="what time 0 waits for where there is a loop: signals, as in `when` of faults",
    )
    start_within: SomeSeconds = Field(default=DEFAULT_START_S, description="how long time 0 may be waited for [s]")

    @field_validator("start")
    @classmethod
    def _start_sound(cls, start: Any) -> Any:
        try:
            condition_of(start if isinstance(start, dict) else {}, Known(1.0, 1.0, SIGNALS, {}))
        except ValueError as error:
            raise wrong(text=str(error)) from None
        return start


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


@dataclass(frozen=True, slots=True)
class Scenario:
    """Entries of each named input by its index, and what differs from the bench's initial state.

    Time 0 is the first tick; where there is a loop the one after that in which `start` first held, which is
    `FIRST_COMMAND` or a condition, and has to come within `start_within` [s]. `stalk` are the driver's movements,
    `marks` times [s] with names, `faults` what is inserted, each with its file and line, `expect` what is expected of
    the run; `title`, `requirement`, `bench` as written; `path` and `text` are the file's.
    """

    seconds: float
    initial: dict[str, float]
    entries: dict[int, tuple[Entry, ...]]
    stalk: tuple[StalkTurn, ...] = ()
    marks: dict[str, float] = field(default_factory=dict)
    faults: Written = ()
    expect: tuple[Placed, ...] = ()
    title: str = ""
    requirement: str = ""
    bench: str | None = None
    path: Path = Path()
    text: str = ""
    start: str | dict[str, Any] = field(default_factory=dict)
    start_within: float = DEFAULT_START_S

    def input_rows(self, input_row: NDArray[np.float64], step_ns: int) -> NDArray[np.float64]:
        """Return the inputs of every tick; times are rounded to ticks, unnamed inputs keep `input_row`.

        Raises
        ------
        Failure
            When that is not one tick, or a ramp begins at no number.
        """
        ticks = round(self.seconds * SECOND_NS / step_ns)
        if not ticks:
            raise Failure(f"a scenario of {self.seconds:g} s is shorter than a tick of {step_ns / SECOND_NS:g} s")
        rows = np.tile(input_row, (ticks, 1))
        for index in self.entries:
            rows[:, index] = self.column(index, input_row, step_ns)
        return rows

    def column(self, index: int, input_row: Floats, step_ns: int) -> Floats:
        """Return one input of every tick; Failure where a ramp begins at no number."""
        column = np.full(round(self.seconds * SECOND_NS / step_ns), input_row[index])
        for entry in self.entries.get(index, ()):
            _apply(column, entry, step_ns, INPUTS[index])
        return column


def load_scenario(name: str | Path) -> Scenario:
    """Read and check a scenario, by its path or by the name of a shipped one.

    Raises
    ------
    BenchError
        With every problem, each with file and line.

    """
    reading = Reading()
    path = resources.named("scenarios", name)
    document = reading.named_file(path)
    if document.problems or not reading.sources:
        reading.raise_problems()
    top = reading.take(document, (), ScenarioFile)
    initial = reading.check(document, ("initial",), _group_at(document, "initial"), InitialSection)
    entries = _entries(reading, document)
    stalk, expect = read_stalk(reading, document), read_expectations(reading, document)
    reading.raise_problems()
    if top is None or initial is None:
        raise AssertionError("a description that failed left no problem behind")
    faults = [(entry, "{}:{}".format(*document.place(("faults", index)))) for index, entry in enumerate(top.faults)]
    return Scenario(
        top.seconds,
        initial.model_dump(include=initial.model_fields_set),
        entries,
        stalk,
        top.marks,
        faults,
        expect,
        top.title,
        top.requirement,
        top.bench,
        path,
        reading.sources[document.file],
        {} if top.start == "first tick" else top.start,
        top.start_within,
    )


def _group_at(document: Document, key: str) -> dict[str, Any]:
    """Return a group; nothing where it is left out, or is none and has been told so."""
    group = document.at((key,))
    return group if isinstance(group, dict) else {}


def _entries(reading: Reading, document: Document) -> dict[int, tuple[Entry, ...]]:
    found: dict[int, tuple[Entry, ...]] = {}
    for name, items in _group_at(document, "signals").items():
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
        if ramp_s and _is_no_quantity(signal, value):
            raise ValueError(f"{signal.name} cannot ramp to '{_SAME}'; ramp to a number from 0 on, then say '{_SAME}'")
        return value, ramp_s, None
    except ValueError as error:
        reading.note(document, location, str(error))
        return None


def _is_no_quantity(signal: Signal, value: float) -> bool:
    """Say whether a value stands for that of another signal, which no ramp can lead to or from."""
    return _SAME in dict(signal.names) and value < 0.0


def _apply(column: NDArray[np.float64], entry: Entry, step_ns: int, signal: Signal) -> None:
    """Write one entry over what came before it."""
    first, ticks = (round(seconds * SECOND_NS / step_ns) for seconds in (entry.time_s, entry.ramp_s))
    if first >= len(column):
        return
    if entry.shape is not None:
        _follow_shape(column[first:], entry.shape, step_ns, (entry.place, signal))
        return
    if ticks and _is_no_quantity(signal, column[first]):
        text = f"{signal.name} is '{_SAME}' when its ramp at {entry.time_s:g} s begins; give it a value before"
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
