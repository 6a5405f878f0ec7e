"""Reads the frame logs of other tools by python-can: BLF, ASC, candump's .log and .trc, also behind .gz."""

import gzip
import logging
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, cast

import can
from can.io.trc import TRCReader

from hilplant.failure import Failure
from hilplant.recording.blf_log import BlfLog
from hilplant.recording.text_logs import Lines, asc_lines, resumed, trc_lines, whole_lines

ENDINGS = (".blf", ".asc", ".log", ".trc")


class LogReading:
    """A log that is read frame by frame; `notes` tell what was skipped, once all frames were given.

    `names` are the identifiers of messages, for an ASC file that has their names instead.
    """

    def __init__(self, path: Path, names: Mapping[str, int] | None = None) -> None:
        self.path, self.names = path, names or {}
        self.notes: list[str] = []
        packed = path.suffix.lower() == ".gz"
        self.ending = Path(path.stem).suffix.lower() if packed else path.suffix.lower()
        self.packed = packed

    def __iter__(self) -> Iterator[can.Message]:
        """Give every frame in its order.

        Raises
        ------
        Failure
            When the file is not such a log.

        """
        logging.getLogger("can.io").setLevel(logging.CRITICAL)  # a line for each damaged object, without end
        try:
            if self.ending == ".blf":
                yield from self._blf()
            else:
                yield from self._text()
        except (OSError, EOFError) as error:
            reason = getattr(error, "strerror", None) or error
            raise Failure(f"{self.path}: cannot be read: {reason}") from error
        except Failure:
            raise
        except Exception as error:  # the readers of python-can let errors of every kind through
            text = " ".join(str(error).split()) or type(error).__name__
            raise Failure(f"{self.path}: cannot be read as a {self.ending[1:].upper()} log: {text}") from error

    def _blf(self) -> Iterator[can.Message]:
        if self.packed:
            raise Failure(f"{self.path}: a BLF file is packed by itself: unpack the .gz first")
        with BlfLog(self.path) as log:
            yield from log
            self.notes += log.notes()

    def _text(self) -> Iterator[can.Message]:
        with self._opened() as file:
            lines = whole_lines(file, self.notes)
            source = self._lines(lines)
            bad: Counter[str] = Counter()
            reader = _READERS[self.ending](cast(Any, source))
            frames = 0
            for message in resumed(reader, source, lambda reason: bad.update([reason])):
                frames += 1
                yield cast(can.Message, message)
            if not frames and source.given:
                raise Failure(f"{self.path}: {_NOT[self.ending]}")
            if bad:
                self.notes.append(f"{bad.total()} lines skipped that are no frame: {bad.most_common(1)[0][0]}")

    def _lines(self, lines: Iterator[str]) -> Lines:
        if self.ending == ".asc":
            return asc_lines(lines, self.names, self.notes)
        return trc_lines(lines) if self.ending == ".trc" else Lines((), lines)

    def _opened(self) -> Any:
        """Open as text: UTF-8, or else the code page of a Western Windows, in which every byte is a letter."""
        open_file: Any = gzip.open if self.packed else open
        with open_file(self.path, "rb") as file:
            head = file.read(1 << 20)
        if head[:2] in (b"\xff\xfe", b"\xfe\xff"):
            return open_file(self.path, "rt", encoding="utf-16", errors="replace")
        encoding = "utf-8-sig"
        try:
            head[: head.rfind(b"\n") + 1 or None].decode(encoding)
        except UnicodeDecodeError:
            encoding = "cp1252"
        return open_file(self.path, "rt", encoding=encoding, errors="replace")


_READERS: dict[str, Any] = {".asc": can.ASCReader, ".log": can.CanutilsLogReader, ".trc": TRCReader}
_NOT = {
    ".asc": "no line of it is a frame as ASC has them",
    ".log": "no line of it is a frame as candump -l writes them: (1700000000.000000) can0 123#1122",
    ".trc": "no line of it is a frame as PCAN-View writes them",
}
