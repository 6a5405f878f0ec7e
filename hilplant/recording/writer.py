"""Rows and frames of a ring -> the blocks of a recording, in one file or in parts."""

from collections import deque
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hilplant.recording.format import CHECKSUM_KEY, LOST_KEY, SIGNAL_COLUMNS, STATE_KEY, batch, checksum, state_text
from hilplant.recording.metadata import part_description
from hilplant.recording.part import Part
from hilplant.recording.rotation import Rotation, part_path
from hilplant.runtime.ring import FRAME_DTYPE, Ring

_STATE_AT = 2 + len(SIGNAL_COLUMNS)
_NEVER_NS = 1 << 62

Rows = NDArray[np.float64]
Frames = NDArray[np.void]


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
        self._kept: deque[Path] = deque()
        self._rows = [np.empty((0, row_width))]
        self._frames = [np.empty(0, FRAME_DTYPE)]
        self._first_ns: int | None = None  # when the first tick of the part was due
        self._part = self._open(metadata)

    def take(self, ring: Ring) -> None:
        """Take what is in the ring: the rows first, so that all frames of these rows are there."""
        self.add(ring.read_rows(), ring.read_frames())

    def add(self, rows: Rows, frames: Frames) -> None:
        """Take rows, and frames of these rows and later ones."""
        self._rows.append(rows)
        self._frames.append(frames)

    def write(self, last: bool = False) -> None:
        """Write what was taken; frames of a tick whose row is still to come wait, unless it never will."""
        rows, frames = np.concatenate(self._rows), np.concatenate(self._frames)
        whole = len(frames)
        if not last:
            newest = rows[-1, 0] if len(rows) else -np.inf
            whole = int(np.searchsorted(frames["tick"], newest, side="right"))
        self._rows, self._frames = [rows[:0]], [frames[whole:]]
        frames = frames[:whole]
        while len(rows):
            count = int(np.searchsorted(rows[:, 1], self._end_ns(rows[0, 1])))
            until = len(frames) if count == len(rows) else int(np.searchsorted(frames["tick"], rows[count, 0]))
            self._write_block(rows[:count], frames[:until])
            rows, frames = rows[count:], frames[until:]
        if len(frames):
            self._write_block(rows, frames)

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

    def _write_block(self, rows: Rows, frames: Frames) -> None:
        begins = len(rows) > 0 and self._first_ns is None
        if begins and self._part.blocks:
            self._next_part(rows)
        values = batch(rows, frames)
        state = state_text(rows[0, _STATE_AT:]) if len(rows) else b""
        metadata = {CHECKSUM_KEY: checksum(values, state)} | ({STATE_KEY: state} if state else {})
        block = self._part.block(values, metadata)
        limit = self._rotation.part_bytes
        if limit and len(rows) and self._part.blocks and self._part.written + len(block) > limit:
            self._next_part(rows)
            block = self._part.block(values, metadata)
            begins = True
        self._part.append(block)
        if begins:
            self._first_ns = int(rows[0, 1])

    def _next_part(self, rows: Rows) -> None:
        """Close the part and open the next, which begins with these rows."""
        self.close()
        self._number += 1
        begin = part_description(self._metadata, self._number, (int(rows[0, 0]), int(rows[0, 1])), rows[0, _STATE_AT:])
        self._part = self._open(begin)
        while self._rotation.keep and len(self._kept) > self._rotation.keep:
            self._kept.popleft().unlink(missing_ok=True)

    def _open(self, metadata: dict[str, str]) -> Part:
        path = part_path(self._path, self._number) if self._rotation.in_parts else self._path
        part = Part(path, metadata)
        self._kept.append(path)
        return part
