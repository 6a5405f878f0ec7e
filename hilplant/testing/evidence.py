"""What a run left, in virtual time or in a recording, as the arrays on which expectations are judged."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from hilplant.arrays import Flags, Floats, Whole
from hilplant.bus.frame import Frame
from hilplant.bus.protection import Checker, FrameCheck, Protection
from hilplant.recording.format import INPUT_COLUMNS, OUTPUT_COLUMNS, STATUS_COLUMNS
from hilplant.recording.reader import Recording, matrix
from hilplant.runtime.commands import COMES, GOES, KINDS, START
from hilplant.runtime.loop import STOPPED
from hilplant.runtime.row import FIRST_OUTPUT, FIRST_STATUS
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, STATUS_INDEX
from hilplant.testing.known_signals import DatabaseSignals
from hilplant.units import SECOND_NS
from hilplant.verdicts.arrays import Trace
from hilplant.verdicts.expectations import Expectation, Frames
from hilplant.verdicts.frames import FrameTimes

MODE = FIRST_STATUS + STATUS_INDEX["mode"]
_EDGES = {KINDS[COMES]: True, KINDS[GOES]: False}
#: Counts whose rise says that time or data were lost in that tick.
LOSSES = [FIRST_STATUS + STATUS_INDEX[name] for name in ("overruns", "missed_frame", "ring_lost", "queue_full")]


class FaultEdge(NamedTuple):
    """A fault that is there from a tick on, or no longer."""

    tick: int
    name: str
    there: bool


@dataclass(frozen=True)
class Evidence:
    """Rows as the loop writes them (tick, deadline, inputs, outputs, status), and every frame with its tick.

    `edges` are the ticks at which faults of a name came and went; `start` is the step, counted as the deadlines are,
    that is the scenario's time 0; `hidden` are steps that count as lost for another reason than the loop's;
    `begun` says whether a scenario began to be played.
    """

    step_ns: int
    rows: Floats
    frame_ticks: Whole
    frames: Sequence[Frame]
    edges: Sequence[FaultEdge] = ()
    start: int = 0
    hidden: Sequence[int] = ()
    begun: bool = True

    def fault_marks(self) -> dict[str, float]:
        """Return when each fault first came and last went [s], by a name for people; what stays has no end."""
        found: dict[str, float] = {}
        for each in self.edges:
            time_s = (each.tick - self.start) * self.step_ns / SECOND_NS
            if each.there:
                found.setdefault(each.name, time_s)
            else:
                found[f"{each.name} ends"] = time_s
        return found

    def trace(self, expectations: Iterable[Expectation], database: DatabaseSignals, ticks: int) -> Trace:
        """Return what these expectations look at, in `ticks` periods from time 0, without the server's last one."""
        wanted = list(expectations)
        places = (self.rows[:, 1] / self.step_ns).round().astype(np.int64)
        stopped = self.rows[:, MODE] == STOPPED
        due = max((places + ~stopped).tolist(), default=0)  # the last one, in which the server stopped, is not due
        count = max(self.start, min(due, self.start + ticks))
        within = (places < count) & ~stopped
        rows, places = self.rows[within], places[within]
        seen = np.zeros(count, np.bool_)
        seen[places] = True
        lost = np.diff(rows[:, LOSSES], axis=0, prepend=0.0).any(axis=1)
        seen[places[lost]] = False
        seen[[step for step in self.hidden if step < count]] = False
        names = dict.fromkeys(name for each in wanted for name in each.signals)
        signals = {name: self._signal(name, rows, places, count, database)[self.start :] for name in names}
        messages = {each.rule.message for each in wanted if isinstance(each.rule, Frames)}
        frames = {name: self._frame_times(database, name, count) for name in messages}
        return Trace(self.step_ns / SECOND_NS, signals, seen[self.start :], frames)

    def signal(self, name: str, database: DatabaseSignals) -> Floats:
        """Return one signal over all rows from time 0 on."""
        places = (self.rows[:, 1] / self.step_ns).round().astype(np.int64)
        count = int(places[-1]) + 1 if len(places) else 0
        return self._signal(name, self.rows, places, count, database)[self.start :]

    def _signal(self, name: str, rows: Floats, places: Whole, count: int, database: DatabaseSignals) -> Floats:
        column = column_of(name)
        values = np.full(count, np.nan)
        if column is not None:
            values[places] = rows[:, column]
            return _held(values, places)
        message, signal = database.signals[name]
        ticks, decoded = self._decoded(message, signal.name)
        within = ticks < count
        values[ticks[within]] = decoded[within]  # of several in a tick the last one stays
        return _held(values, np.unique(ticks[within]))

    def _decoded(self, message: Any, signal: str) -> tuple[Whole, Floats]:
        places = self._places(message)
        found = [(index, value_of(message, self.frames[index].data, signal)) for index in places]
        kept = [(index, value) for index, value in found if value is not None]
        ticks = self.frame_ticks[[index for index, _ in kept]] if kept else np.zeros(0, np.int64)
        return ticks, np.array([value for _, value in kept], np.float64)

    def _places(self, message: Any) -> list[int]:
        wanted = (message.frame_id, message.is_extended_frame)
        return [
            index
            for index, frame in enumerate(self.frames)
            if (frame.identifier, frame.extended) == wanted and not (frame.remote or frame.error)
        ]

    def _frame_times(self, database: DatabaseSignals, name: str, count: int) -> FrameTimes:
        message, protection = database.messages[name], database.protections.get(name)
        places = [index for index in self._places(message) if self.frame_ticks[index] < count]
        counter, crc = checked_frames(protection, [self.frames[index].data for index in places])
        ticks = self.frame_ticks[places] - self.start if places else np.zeros(0, np.int64)
        kept = ticks >= 0
        counter, crc = (found[kept] if len(found) else found for found in (counter, crc))
        return FrameTimes(ticks[kept], float(message.cycle_time or 0.0), counter, crc)


def column_of(name: str) -> int | None:
    """Return the place of a plant's signal in a row: outputs first, then status, then inputs; None for another's."""
    if name in OUTPUT_INDEX:
        return FIRST_OUTPUT + OUTPUT_INDEX[name]
    if name in STATUS_INDEX:
        return FIRST_STATUS + STATUS_INDEX[name]
    return 2 + INPUT_INDEX[name] if name in INPUT_INDEX else None


def recorded(recording: Recording) -> Evidence:
    """Return what a recording holds; time 0 is where a scenario began to be played, else the first tick."""
    start: int | None = None
    rows, ticks, frames, edges = [], [], [], []
    step_ns = recording.run.step_ns
    for batch in recording.batches():
        values = matrix(batch, ("tick", "deadline_ns", *INPUT_COLUMNS, *OUTPUT_COLUMNS, *STATUS_COLUMNS))
        rows.append(values[~np.isnan(values[:, 1])])
        for frame in batch.column("frames").flatten().to_pylist():
            ticks.append(round(frame["time_ns"] / step_ns))
            flags = [frame[flag] for flag in ("extended", "fd", "bitrate_switch", "remote", "error")]
            frames.append(Frame(frame["identifier"], frame["data"], *flags))
        for event in batch.column("events").flatten().to_pylist():
            if event["kind"] in _EDGES:
                edges.append(FaultEdge(round(event["time_ns"] / step_ns), event["text"], _EDGES[event["kind"]]))
            if event["kind"] == KINDS[START] and start is None:
                start = round(event["time_ns"] / step_ns)
    whole = np.concatenate(rows)
    begun = start is not None
    if start is None:
        start = round(whole[0, 1] / step_ns) if len(whole) else 0
    return Evidence(step_ns, whole, np.array(ticks, np.int64), frames, edges, start, begun=begun)


def _held(values: Floats, places: Whole) -> Floats:
    """Fill every tick that has no value with that of the tick before; nan before the first."""
    if not len(places):
        return values
    source = np.full(len(values), -1, np.int64)
    source[places] = places
    source = np.maximum.accumulate(source)
    return np.where(source >= 0, values[source], np.nan)


def value_of(message: Any, data: bytes, signal: str) -> float | None:
    """Decode one signal; None where the frame is too short, or its page is another."""
    if len(data) < message.length:
        return None
    value = message.decode(data, decode_choices=False).get(signal)
    return None if value is None else float(value)


def checked_frames(protection: Protection | None, payloads: Sequence[bytes]) -> tuple[Flags, Flags]:
    """Say of each frame whether its counter and its checksum are right; one counter that jumps counts once."""
    counter, crc = [], []
    checker = Checker(protection) if protection is not None else None
    for data in payloads if checker is not None else ():
        found = checker.check(data)  # type: ignore[union-attr]
        counter.append(found is not FrameCheck.WRONG_COUNTER)
        crc.append(found is not FrameCheck.WRONG_CRC)
        if found is FrameCheck.WRONG_COUNTER:
            checker.reset()  # type: ignore[union-attr]
            found = checker.check(data)  # type: ignore[union-attr]
        if found is FrameCheck.OK:
            checker.accept()  # type: ignore[union-attr]
    return np.array(counter, np.bool_), np.array(crc, np.bool_)
