"""A scenario file: what drives the plant over time, when nothing on a bus does."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, WithJsonSchema, field_validator

from hilplant import resources
from hilplant.arrays import Floats
from hilplant.bench.description import InitialSection
from hilplant.bench.durations import Seconds, SomeSeconds
from hilplant.checked_yaml.checked import Checked, wrong
from hilplant.checked_yaml.reading import Reading
from hilplant.checked_yaml.yaml_reader import Document
from hilplant.ecu.stalk import StalkTurn
from hilplant.failure import Failure
from hilplant.faults.written import SIGNALS, FaultEntry, Written
from hilplant.signals import INPUTS
from hilplant.simulation.entries import Entry, apply, read_entries
from hilplant.simulation.scenario_schema import EntriesOfInputs
from hilplant.simulation.scenario_sections import read_expectations, read_stalk
from hilplant.units import SECOND_NS
from hilplant.verdicts.binding import Placed
from hilplant.verdicts.conditions import condition_of
from hilplant.verdicts.known import Known

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

    def input_rows(self, input_row: Floats, step_ns: int) -> Floats:
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
            apply(column, entry, step_ns, INPUTS[index])
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
    entries = read_entries(reading, document, _group_at(document, "signals"))
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
