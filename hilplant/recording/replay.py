"""Runs the inputs of a recording through the same step again and compares every bit of every output."""

from dataclasses import dataclass
from os import PathLike

import numpy as np

from hilplant.arrays import Floats, Whole
from hilplant.models.plant import simulate_rows
from hilplant.recording.format import INPUT_COLUMNS, OUTPUT_COLUMNS, parameter_changes
from hilplant.recording.metadata import current_build
from hilplant.recording.reader import Block, Recording, matrix, read_recording
from hilplant.signals import OUTPUTS


@dataclass(frozen=True)
class Difference:
    """The first output that came out otherwise."""

    tick: int
    signal: str
    recorded: float
    replayed: float

    def __str__(self) -> str:
        """Both values, with all their digits."""
        text = f"tick {self.tick}, {self.signal}: recorded {self.recorded!r}, replayed {self.replayed!r}"
        return text + (" (their bits differ)" if repr(self.recorded) == repr(self.replayed) else "")


@dataclass(frozen=True)
class ReplayResult:
    """What a replay found."""

    equal: bool
    ticks: int  # compared and equal
    outputs: int  # that were compared
    difference: Difference | None
    missing: tuple[tuple[int, int], ...]  # first and last tick of each gap in the recording
    notes: tuple[str, ...]

    def __str__(self) -> str:
        """One line of verdict, then one for each note."""
        if self.equal:
            verdict = f"equal: all {self.outputs} outputs of {self.ticks} ticks, bit for bit"
        elif self.difference is not None:
            verdict = f"different: {self.difference}; the {self.ticks} ticks before are equal"
        elif self.missing:
            verdict = f"incomplete: {self.ticks} ticks are equal, but the recording has gaps"
        else:
            verdict = "empty: the recording holds no ticks"
        gaps = [f"missing: ticks {first} to {last}" for first, last in self.missing]
        return "\n".join([verdict, *gaps, *self.notes])


class _Comparison:
    """The plant of the recording, and how far its replay has come."""

    def __init__(self, recording: Recording) -> None:
        self._run = recording.run
        self._state = recording.run.state_row.copy()
        self._parameters = recording.run.parameter_row.copy()
        self._next = recording.run.first_tick
        self.outputs = np.array([name not in recording.missing for name in OUTPUT_COLUMNS])
        self.ticks = 0
        self.difference: Difference | None = None
        self.missing: list[tuple[int, int]] = []

    def add(self, block: Block) -> None:
        """Compare a block: to the first gap in it; and after a gap before it from the state that the block tells."""
        rows = block.rows.filter(block.rows.column("deadline_ns").is_valid())
        changes = parameter_changes(block.rows)
        if not len(rows):
            self._change(changes)
            return
        ticks = rows.column("tick").to_numpy()
        if ticks[0] != self._next:
            self.missing.append((self._next, int(ticks[0]) - 1))
        known = not self.missing or block.state_row is not None
        if self.missing and block.state_row is not None:
            self._state = block.state_row.copy()
        unbroken = self._count_gaps(ticks)
        if self.difference is not None or not known:
            self._change(changes)
            return
        inputs, recorded = matrix(rows, INPUT_COLUMNS)[:unbroken], matrix(rows, OUTPUT_COLUMNS)[:unbroken]
        replayed = np.full_like(recorded, np.nan)
        first = 0
        for tick, index, value in [*changes, (int(ticks[-1]) + 1, None, 0.0)]:
            until = int(np.searchsorted(ticks[:unbroken], tick))
            simulate_rows(self._state, inputs[first:until], self._parameters, self._run.tables, replayed[first:until])
            first = until
            if index is not None:
                self._parameters[index] = value
        self._compare(ticks, recorded, replayed)

    def _change(self, changes: list[tuple[int, int, float]]) -> None:
        for _, index, value in changes:
            self._parameters[index] = value

    def _count_gaps(self, ticks: Whole) -> int:
        """Note the ticks that are missing in a block, and return how many rows come before the first of them."""
        broken = np.flatnonzero(np.diff(ticks) != 1)
        self.missing += [(int(ticks[at]) + 1, int(ticks[at + 1]) - 1) for at in broken]
        self._next = int(ticks[-1]) + 1
        return int(broken[0]) + 1 if len(broken) else len(ticks)

    def _compare(self, ticks: Whole, recorded: Floats, replayed: Floats) -> None:
        different = recorded.view(np.uint64) != replayed.view(np.uint64)  # so that NaN and -0 count as they are
        different &= self.outputs
        if not different.any():
            self.ticks += len(recorded)
            return
        row, column = (int(index) for index in np.argwhere(different)[0])
        self.ticks += row
        values = float(recorded[row, column]), float(replayed[row, column])
        self.difference = Difference(int(ticks[row]), OUTPUTS[column].name, *values)


def replay(path: str | PathLike[str]) -> ReplayResult:
    """Repeat a recording.

    Raises
    ------
    Failure
        When the file is not a recording, or damaged.
    """
    recording = read_recording(path)
    comparison = _Comparison(recording)
    for block in recording.blocks():
        comparison.add(block)
    equal = comparison.difference is None and not comparison.missing and comparison.ticks > 0
    notes = list(recording.notes)
    if absent := [signal.name for signal, there in zip(OUTPUTS, comparison.outputs, strict=True) if not there]:
        notes.append(f"not compared, as the recording has them not: {', '.join(absent)}")
    if comparison.difference is not None:
        notes.append(_likely_reason(recording.run.build))
    gaps, outputs = tuple(comparison.missing), int(comparison.outputs.sum())
    return ReplayResult(equal, comparison.ticks, outputs, comparison.difference, gaps, tuple(notes))


def _likely_reason(build: dict[str, str]) -> str:
    here = current_build()
    changed = [
        f"{name} was {build.get(name, 'unknown')}, is {here[name]}" for name in here if build.get(name) != here[name]
    ]
    if changed:
        return "likely because this build is another one: " + "; ".join(changed)
    return "this is the same build that recorded it: the recording was altered, or the run was not deterministic"
