"""BLF as python-can reads it, with a look at each object first: damaged files end, and what is skipped is counted."""

import os
import struct
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import can
from can.io.blf import BLFReader

_OBJECT = struct.Struct("<4sHHLL")  # signature, header size, header version, object size, type
_MARK = b"LOBJ"
#: No object with a frame is larger: one that says so is damaged.
LARGEST = 1 << 20
#: Types of objects that hold CAN frames.
_FRAMES = (1, 73, 86, 100, 101)


class BlfLog(BLFReader):
    """Gives the frames of a BLF file; `skipped` counts what could not be read, by its reason."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.skipped: Counter[str] = Counter()
        self.missing = max(0, self.file_size - os.path.getsize(path))
        self.rest = b""

    def __iter__(self) -> Iterator[can.Message]:  # type: ignore[override]
        """Give frames up to the end, or to where the containers themselves break off."""
        try:
            yield from super().__iter__()
        except Exception as error:  # python-can and zlib have errors of their own
            self.skipped[f"what is behind a damaged container ({str(error) or type(error).__name__})"] += 1
        if self.rest:
            self.skipped["an object without its end"] += 1

    def _parse_container(self, data: bytes) -> Iterator[can.Message]:
        """Read the whole objects of a container; the beginning of one waits for the next container."""
        data, at = self.rest + data, 0
        self.rest = b""
        while at < len(data):
            start = data.find(_MARK, at)
            if start < 0 or start + _OBJECT.size > len(data):
                self.rest = data[max(at, len(data) - _OBJECT.size) if start < 0 else start :]
                self.rest = self.rest if self.rest.strip(b"\0") else b""
                return
            if data[at:start].strip(b"\0") and start - at > 3:
                self.skipped["bytes that are no object"] += 1
            _, header, version, size, kind = _OBJECT.unpack_from(data, start)
            if not _OBJECT.size <= header <= size <= LARGEST:
                self.skipped[f"an object of size {size}"] += 1
                at = start + len(_MARK)
                continue
            if start + size > len(data):
                self.rest = data[start:]
                return
            at = start + size
            if kind in _FRAMES:
                yield from self._frame(data[start:at], version)

    def _frame(self, data: bytes, version: int) -> Iterator[can.Message]:
        if version not in (1, 2):
            self.skipped[f"a frame with a header of version {version}"] += 1
            return
        try:
            yield from cast(Any, self)._parse_data(data)
        except Exception as error:
            self.skipped[f"a frame that cannot be read ({str(error) or type(error).__name__})"] += 1

    def notes(self) -> list[str]:
        """Return what was skipped, and whether the end is missing, in words."""
        notes = [f"skipped {count} times: {reason}" for reason, count in self.skipped.items()]
        if self.missing:
            notes.append(f"the file is cut off: {self.missing} bytes of its end are missing, what is there was read")
        return notes
