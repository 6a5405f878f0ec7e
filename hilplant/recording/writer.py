"""Rows and frames of a ring -> the blocks of a recording, in one file or in parts."""

from collections import deque
from pathlib import Path

import numpy as np

from hilplant.arrays import Floats, Records
from hilplant.models.records import STATE_INDEX
from hilplant.recording.format import CHECKSUM_KEY, LOST_KEY, SIGNAL_COLUMNS, STATE_KEY, batch, checksum, state_text
from hilplant.recording.metadata import Begin, parameters_of, part_description
from hilplant.recording.part import Part
from hilplant.recording.rotation import Rotation, part_path, remove_part
from hilplant.runtime.commands import APPLIED, COMMAND_DTYPE, PARAMETER
from hilplant.runtime.frame_slot import FRAME_DTYPE
from hilplant.runtime.ring import Ring

_STATE = slice(2 + len(SIGNAL_COLUMNS), 2 + len(SIGNAL_COLUMNS) + len(STATE_INDEX))
_NEVER_NS = 1 << 62

_NO_EVENTS = np.empty(0, COMMAND_DTYPE)


class EventsLost(OSError):
    """Commands were overwritten before they were recorded: replay could not repeat the run."""


def change_parameters(parameter_row: Floats, events: Records) -> None:
    """Change a parameter row as these events have changed the loop's."""
    changes = events[(events["kind"] == PARAMETER) & (events["outcome"] == APPLIED)]
    for change in changes:
        parameter_row[change["element"]] = change["value"]


def late_description(metadata: dict[str, str], ring: Ring) -> dict[str, str]:
    """Return the description of a recording that begins in the midst of a run, with the first row it takes."""
    row = ring.next_unread()
    events = ring.events.since(0)
    if events.lost:
        raise EventsLost(0, "there were too many commands for a recording that begins late")
    parameter_row = parameters_of(metadata)
    change_parameters(parameter_row, events.records[events.records["tick"] < row[0]])
    return part_description(metadata, 1, Begin(int(row[0]), int(row[1]), row[_STATE], parameter_row))


class RecordingWriter:
    """Writes what the ring gives, as blocks of an Arrow stream; each part is read and replayed without the others."""

    def __init__(self, path: Path, metadata: dict[str, str], row_width: int, rotation: Rotation | None = None) -> None:
        """Open the first file.

        Raises
        ------
        OSError
            When it exists already or cannot be written.
        """
        self._path = path
        self._metadata = metadata
        self._rotation = rotation or Rotation()
        self._number = 1
        self._kept = deque(Path(earlier) for earlier in self._rotation.earlier)
        self._rows = [np.empty((0, row_width))]
        self._frames = [np.empty(0, FRAME_DTYPE)]
        self._events = [_NO_EVENTS]
        self._event_place, self._parameters = 0, parameters_of(metadata)
        self._first_tick = int(metadata["first_tick"])
        self._first_ns: int | None = None  # when the first tick of the part was due
        self._part = self._open(metadata)

    def take(self, ring: Ring) -> None:
        """Take what is in the ring: the rows first, so that all frames and events of these rows are there.

        Raises
        ------
        EventsLost
            When events were overwritten.
        """
        rows, frames = ring.read_rows(), ring.read_frames()
        events, self._event_place, lost = ring.events.since(self._event_place)
        if lost:
            raise EventsLost(0, f"{lost} commands were overwritten before they were recorded")
        self.add(rows, frames, events[events["tick"] >= self._first_tick])

    def add(self, rows: Floats, frames: Records, events: Records = _NO_EVENTS) -> None:
        """Take rows, and frames and events of these rows and later ones."""
        self._rows.append(rows)
        self._frames.append(frames)
        self._events.append(events)

    def write(self, last: bool = False) -> None:
        """Write what was taken; what is of a tick whose row is still to come waits, unless it never will."""
        rows = np.concatenate(self._rows)
        frames, events = np.concatenate(self._frames), np.concatenate(self._events)
        newest = rows[-1, 0] if len(rows) else -np.inf
        beside, waiting = _parted((frames, events), np.inf if last else newest + 1)
        self._rows, self._frames, self._events = [rows[:0]], [waiting[0]], [waiting[1]]
        while len(rows):
            count = int(np.searchsorted(rows[:, 1], self._end_ns(rows[0, 1])))
            now, beside = _parted(beside, np.inf if count == len(rows) else rows[count, 0])
            self._write_block(rows[:count], *now)
            rows = rows[count:]
        if len(beside[0]) or len(beside[1]):
            self._write_block(rows, *beside)

    @property
    def path(self) -> Path:
        """Return the file that is written now."""
        return self._part.path

    def check(self) -> None:
        """Raise PartLost unless the file is where it was, and what it was."""
        self._part.check()

    def sync(self) -> None:
        """Ask the disk to keep what was written."""
        self._part.sync()

    def close(self, lost: int = 0) -> None:
        """End the stream, saying how many rows and frames did not come here."""
        if lost:
            nothing = batch(self._rows[0][:0], self._frames[0][:0])
            self._part.append(self._part.block(nothing, {LOST_KEY: b"%d" % lost}))
        self._part.close()

    def abandon(self) -> None:
        """End the stream as far as that is possible."""
        self._part.abandon()

    def _end_ns(self, next_ns: float) -> int:
        """Return when the part ends, opening the next one where it has ended by `next_ns`."""
        length_ns = self._rotation.part_ns
        if not length_ns:
            return _NEVER_NS
        if self._first_ns is not None and next_ns >= self._first_ns + length_ns:
            self._first_ns = None  # the next block begins a part
        return int(next_ns if self._first_ns is None else self._first_ns) + length_ns

    def _write_block(self, rows: Floats, frames: Records, events: Records) -> None:
        begins = len(rows) > 0 and self._first_ns is None
        if begins and self._part.blocks:
            self._next_part(rows)
        values = batch(rows, frames, events)
        state = state_text(rows[0, _STATE]) if len(rows) else b""
        metadata = {CHECKSUM_KEY: checksum(values, state)} | ({STATE_KEY: state} if state else {})
        block = self._part.block(values, metadata)
        limit = self._rotation.part_bytes
        if limit and len(rows) and self._part.blocks and self._part.written + len(block) > limit:
            self._next_part(rows)
            block = self._part.block(values, metadata)
            begins = True
        self._part.append(block)
        change_parameters(self._parameters, events)
        if begins:
            self._first_ns = int(rows[0, 1])

    def _next_part(self, rows: Floats) -> None:
        """Close the part and open the next, which begins with these rows."""
        self.close()
        self._number += 1
        begin = Begin(int(rows[0, 0]), int(rows[0, 1]), rows[0, _STATE], self._parameters)
        self._part = self._open(part_description(self._metadata, self._number, begin))

    def _open(self, metadata: dict[str, str]) -> Part:
        path = part_path(self._path, self._number) if self._rotation.in_parts else self._path
        part = Part(path, metadata)
        self._kept.append(path)
        while self._rotation.keep and len(self._kept) > self._rotation.keep:
            remove_part(self._kept.popleft())
        return part


def _parted(records: tuple[Records, Records], tick: float) -> tuple[tuple[Records, Records], tuple[Records, Records]]:
    """Return what is of ticks before `tick`, and the rest."""
    (frames, events), at = records, [int(np.searchsorted(each["tick"], tick)) for each in records]
    return (frames[: at[0]], events[: at[1]]), (frames[at[0] :], events[at[1] :])
