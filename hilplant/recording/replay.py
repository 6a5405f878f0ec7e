"""Runs the inputs of a recording through the same step again and compares every bit of every output."""

from dataclasses import dataclass
from os import PathLike

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from hilplant.models.plant import simulate_rows
from hilplant.recording.format import INPUT_COLUMNS, OUTPUT_COLUMNS
from hilplant.recording.metadata import current_build
from hilplant.recording.reader import Recording, matrix, read_recording
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
    difference: Difference | None
    missing: tuple[tuple[int, int], ...]  # first and last tick of each gap in the recording
    notes: tuple[str, ...]

    def __str__(self) -> str:
        """One line of verdict, then one for each note."""
        if self.equal:
            verdict = f"equal: all {len(OUTPUTS)} outputs of {self.ticks} ticks, bit for bit"
        elif self.difference is not None:
            verdict = f"different: {self.difference}; the {self.ticks} ticks before are equal"
        elif self.missing:
            verdict = f"incomplete: the first {self.ticks} ticks are equal, then the recording has gaps"
        else:
            verdict = "empty: the recording holds no ticks"
        gaps = [f"missing: ticks {first} to {last}" for first, last in self.missing]
        return "\n".join([verdict, *gaps, *self.notes])


class _Comparison:
    """The plant of the recording, and how far its replay has come."""

    def __init__(self, recording: Recording) -> None:
        self._run = recording.run
        self._state = recording.run.state_row.copy()
        self._next = 0
        self.ticks = 0
        self.difference: Difference | None = None
        self.missing: list[tuple[int, int]] = []

    def add(self, rows: pa.RecordBatch) -> None:
        """Compare a batch, as far as nothing is missing before it."""
        rows = rows.filter(rows.column("deadline_ns").is_valid())
        if not len(rows):
            return
        ticks = rows.column("tick").to_numpy()
        before = len(self.missing)
        unbroken = self._count_gaps(ticks)
        if before or self.difference is not None or not unbroken:
            return
        inputs, recorded = matrix(rows, INPUT_COLUMNS)[:unbroken], matrix(rows, OUTPUT_COLUMNS)[:unbroken]
        replayed = np.full_like(recorded, np.nan)
        simulate_rows(self._state, inputs, self._run.parameter_row, self._run.tables, replayed)
        self._compare(ticks, recorded, replayed)

    def _count_gaps(self, ticks: NDArray[np.int64]) -> int:
        """Note the ticks that are missing, and return how many rows come before the first of them."""
        expected = np.concatenate([[self._next], ticks[:-1] + 1])
        broken = np.flatnonzero(ticks != expected)
        self.missing += [(int(expected[at]), int(ticks[at]) - 1) for at in broken]
        self._next = int(ticks[-1]) + 1
        return int(broken[0]) if len(broken) else len(ticks)

    def _compare(self, ticks: NDArray[np.int64], recorded: NDArray[np.float64], replayed: NDArray[np.float64]) -> None:
        different = recorded.view(np.uint64) != replayed.view(np.uint64)  # so that NaN and -0 count as they are
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
    for rows in recording.batches():
        comparison.add(rows)
    equal = comparison.difference is None and not comparison.missing and comparison.ticks > 0
    notes = list(recording.notes)
    if comparison.difference is not None:
        notes.append(_likely_reason(recording.run.build))
    return ReplayResult(equal, comparison.ticks, comparison.difference, tuple(comparison.missing), tuple(notes))


def _likely_reason(build: dict[str, str]) -> str:
    here = current_build()
    changed = [
        f"{name} was {build.get(name, 'unknown')}, is {here[name]}" for name in here if build.get(name) != here[name]
    ]
    if changed:
        return "likely because this build is another one: " + "; ".join(changed)
    return "this is the same build that recorded it: the recording was altered, or the run was not deterministic"
