"""Opens a recording and gives its batches one by one; a cut-off tail is a note, damage is an error."""

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import pyarrow as pa

from hilplant.failure import Failure
from hilplant.recording.format import CHECKSUM_KEY, FORMAT_VERSION, KEY_PREFIX, checksum, schema
from hilplant.recording.metadata import RunDescription, parse


@dataclass
class Recording:
    """An open recording: the run it is of, and its rows batch by batch."""

    path: Path
    run: RunDescription
    notes: list[str] = field(default_factory=list)  # filled while the batches are read

    def batches(self) -> Iterator[pa.RecordBatch]:
        """Give the rows in the order of their ticks; each call reads the file from its start.

        Raises
        ------
        Failure
            When the file is damaged before its end.
        """
        with open(self.path, "rb") as file:
            stream = pa.ipc.open_stream(file)
            number = 0
            while (rows := self._next(stream, file, number)) is not None:
                yield rows
                number += 1

    def table(self, columns: list[str] | None = None) -> pa.Table:
        """Return all rows, or some of their columns, at once."""
        names = columns or schema({}).names
        parts = [batch.select(names) for batch in self.batches()]
        return pa.Table.from_batches(parts, pa.schema([schema({}).field(name) for name in names]))

    def _next(self, stream: Any, file: BinaryIO, number: int) -> pa.RecordBatch | None:
        try:
            rows, metadata = stream.read_next_batch_with_custom_metadata()
            rows.validate(full=True)
        except StopIteration:
            self._note_end(file)
            return None
        except (pa.ArrowException, OSError, ValueError) as error:
            if file.tell() >= os.fstat(file.fileno()).st_size:
                self._note_cut()
                return None
            raise Failure(f"{self.path}: damaged in block {number}: {_first_line(error)}") from error
        stored = metadata.get(CHECKSUM_KEY) if metadata else None
        if stored is not None and stored != checksum(rows):
            ticks = rows.column("tick")
            span = f"ticks {ticks[0]} to {ticks[-1]}"
            raise Failure(f"{self.path}: damaged in block {number}: the values of {span} fail their checksum")
        return rows

    def _note_end(self, file: BinaryIO) -> None:
        file.seek(-8, os.SEEK_END)
        if file.read() != b"\xff\xff\xff\xff\0\0\0\0":  # the end mark of an Arrow stream
            self._note_cut()

    def _note_cut(self) -> None:
        note = "the recording was cut off: its writer was killed; all whole blocks before that are used"
        if note not in self.notes:
            self.notes.append(note)


def read_recording(path: str | os.PathLike[str]) -> Recording:
    """Open a recording.

    Raises
    ------
    Failure
        When there is no such file, or it is not a recording.
    """
    path = Path(path)
    try:
        with open(path, "rb") as file:
            found = pa.ipc.open_stream(file).schema
    except (pa.ArrowException, ValueError) as error:
        raise Failure(f"{path}: not a recording of hilplant") from error
    except OSError as error:
        raise Failure(f"{path}: cannot be read: {error.strerror or _first_line(error)}") from error
    texts = {_text(key): _text(value) for key, value in (found.metadata or {}).items()}
    metadata = {key.removeprefix(KEY_PREFIX): value for key, value in texts.items() if key.startswith(KEY_PREFIX)}
    if "format" not in metadata:
        raise Failure(f"{path}: not a recording of hilplant")
    if metadata["format"] != FORMAT_VERSION:
        raise Failure(f"{path}: has format {metadata['format']}, this version reads format {FORMAT_VERSION}")
    if found.names != schema({}).names:
        unknown = sorted(set(found.names) ^ set(schema({}).names))
        raise Failure(f"{path}: has other columns than this version's: {', '.join(unknown) or 'another order'}")
    try:
        return Recording(path, parse(metadata))
    except (KeyError, ValueError, TypeError) as error:
        raise Failure(f"{path}: its description of the run is unreadable ({error})") from error


def matrix(rows: pa.RecordBatch, names: tuple[str, ...]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return some columns as an array of one row for each tick; nulls become NaN."""
    columns = [rows.column(name).to_numpy(zero_copy_only=False) for name in names]
    return np.ascontiguousarray(np.stack(columns, axis=1), dtype=np.float64)


def _text(stored: bytes) -> str:
    return stored.decode(errors="replace")  # damage is for the checksum to find


def _first_line(error: Exception) -> str:
    return str(error).strip().partition("\n")[0] or type(error).__name__
