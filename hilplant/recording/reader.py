"""Opens a recording, or its parts as one, and gives it block by block; a cut-off tail is a note, damage is an error."""

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np
import pyarrow as pa

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.recording.adoption import adopted_rows, missing_columns, undescribed_columns, unknown_columns
from hilplant.recording.elements import ROWS, Elements, ForeignElement, adopted_row
from hilplant.recording.format import (
    CHECKSUM_KEY,
    KEY_PREFIX,
    LOST_KEY,
    OUTPUT_TYPES,
    STATE_KEY,
    checksum,
    schema,
    state_of,
)
from hilplant.recording.metadata import RunDescription, parse
from hilplant.recording.rotation import parts_of
from hilplant.recording.span import EVERYTHING, Span, begin_of


class Block(NamedTuple):
    """Some rows in the order of their ticks, and the plant's state before the first whole one; None without one."""

    rows: pa.RecordBatch
    state_row: Floats | None


@dataclass
class Recording:
    """An open recording: the run it is of, and its rows batch by batch."""

    path: Path
    run: RunDescription  # of the first part
    parts: tuple[Path, ...]
    first_ns: tuple[int, ...]  # when the first tick of each part was due, from the loop's start
    missing: tuple[str, ...] = ()  # columns of outputs and status that it lacks; they are null
    notes: list[str] = field(default_factory=list)  # filled while the batches are read
    span: Span = EVERYTHING

    def batches(self) -> Iterator[pa.RecordBatch]:
        """Give the rows in the order of their ticks; each call reads the files from their start.

        Raises
        ------
        Failure
            When a file is damaged before its end.
        """
        return (block.rows for block in self.blocks())

    def within(self, span: Span) -> "Recording":
        """Return the recording of this stretch of time.

        Raises
        ------
        Failure
            When the stretch is empty, or begins when the recording has ended.
        """
        if span.from_s >= span.to_s:
            raise Failure(
                f"{self.path}: a range goes from a time to a later one, not from {span.from_s:g} to {span.to_s:g} s"
            )
        return replace(self, span=span)

    def blocks(self) -> Iterator[Block]:
        """Give the rows as `batches` does, each batch with the state before it, if it is whole."""
        for part, first_ns, next_ns in zip(self.parts, self.first_ns, (*self.first_ns[1:], None), strict=True):
            if self.span.ends_by(first_ns):
                return
            if next_ns is not None and self.span.begins_after(next_ns):
                continue
            with open(part, "rb") as file:
                for block in _PartReader(part, file, self.run.elements, self.notes).blocks(self.span):
                    if self.span.ends_before(block.rows):
                        return
                    rows = self.span.cut(block.rows)
                    if len(rows) == len(block.rows):
                        yield block
                    elif len(rows):
                        yield Block(rows, None)

    def table(self, columns: list[str] | None = None) -> pa.Table:
        """Return all rows, or some of their columns, at once."""
        names = columns or schema().names
        parts = [batch.select(names) for batch in self.batches()]
        return pa.Table.from_batches(parts, pa.schema([schema().field(name) for name in names]))


class _PartReader:
    """Reads the blocks of one file."""

    def __init__(self, path: Path, file: BinaryIO, elements: Mapping[str, Elements], notes: list[str]) -> None:
        self._path, self._file, self._elements, self._notes = path, file, elements, notes

    def blocks(self, span: Span) -> Iterator[Block]:
        """Give all whole blocks from the one on with which the span begins."""
        place, number = begin_of(self._file, span) if span.from_s > 0.0 else (0, 0)
        self._file.seek(0)
        stream = pa.ipc.open_stream(self._file)
        self._file.seek(max(place, self._file.tell()))
        while (block := self._next(stream, number)) is not None:
            yield block
            number += 1

    def _next(self, stream: Any, number: int) -> Block | None:
        try:
            rows, metadata = stream.read_next_batch_with_custom_metadata()
            rows.validate(full=True)
        except StopIteration:
            self._note_end()
            return None
        except (pa.ArrowException, OSError, ValueError) as error:
            if self._file.tell() >= os.fstat(self._file.fileno()).st_size:
                self._note_cut()
                return None
            raise Failure(f"{self._path}: damaged in block {number}: {_first_line(error)}") from error
        stored = metadata or {}
        if LOST_KEY in stored:
            self._note(f"{_text(stored[LOST_KEY])} ticks or frames are missing: the recorder was too slow for them")
        state = stored.get(STATE_KEY, b"")
        if CHECKSUM_KEY in stored and stored[CHECKSUM_KEY] != checksum(rows, state):
            ticks = rows.column("tick")
            span = f"ticks {ticks[0]} to {ticks[-1]}"
            raise Failure(f"{self._path}: damaged in block {number}: the values of {span} fail their checksum")
        try:
            return Block(adopted_rows(rows, self._elements.get("inputs", {})), self._state(state))
        except (ForeignElement, ValueError) as error:
            raise Failure(f"{self._path}: block {number}: {error}") from error

    def _state(self, text: bytes) -> Floats | None:
        return adopted_row(state_of(text), self._elements["state_row"], ROWS["state_row"]) if text else None

    def _note_end(self) -> None:
        self._file.seek(-8, os.SEEK_END)
        if self._file.read() != b"\xff\xff\xff\xff\0\0\0\0":  # the end mark of an Arrow stream
            self._note_cut()

    def _note_cut(self) -> None:
        self._note("was cut off: its writer was killed, or had no room; all whole blocks before that are used")

    def _note(self, text: str) -> None:
        note = f"{self._path}: {text}"
        if note not in self._notes:
            self._notes.append(note)


def read_recording(path: str | os.PathLike[str]) -> Recording:
    """Open a recording; a path that is no file, but of which there are parts, stands for all of them.

    Raises
    ------
    Failure
        When there is no such file, it is not a recording, or the parts are of several runs.
    """
    path = Path(path)
    parts = [path] if path.exists() else parts_of(path) or [path]
    schemas = [_schema(part) for part in parts]
    runs = [_description(part, found) for part, found in zip(parts, schemas, strict=True)]
    for part, run in zip(parts, runs, strict=True):
        if run.series != runs[0].series:
            raise Failure(f"{part}: is of another run than {parts[0]}; name the parts one by one")
    recording = Recording(path, runs[0], tuple(parts), tuple(run.first_ns for run in runs), missing_columns(schemas[0]))
    if unknown := unknown_columns(schemas[0], "out.", "status."):
        recording.notes.append(f"{path}: not read, as this version does not know it: {', '.join(unknown)}")
    return recording


def _schema(path: Path) -> pa.Schema:
    try:
        with open(path, "rb") as file:
            return pa.ipc.open_stream(file).schema
    except (pa.ArrowException, ValueError) as error:
        raise Failure(f"{path}: not a recording of hilplant") from error
    except OSError as error:
        raise Failure(f"{path}: cannot be read: {error.strerror or _first_line(error)}") from error


def _description(path: Path, found: pa.Schema) -> RunDescription:
    texts = {_text(key): _text(value) for key, value in (found.metadata or {}).items()}
    metadata = {key.removeprefix(KEY_PREFIX): value for key, value in texts.items() if key.startswith(KEY_PREFIX)}
    if "format" not in metadata:
        raise Failure(f"{path}: not a recording of hilplant")
    if metadata["format"] not in OUTPUT_TYPES:
        known = ", ".join(OUTPUT_TYPES)
        raise Failure(f"{path}: has format {metadata['format']}, this version reads the formats {known}")
    _check_columns(path, found, OUTPUT_TYPES[metadata["format"]])
    try:
        run = parse(metadata)
        undescribed = undescribed_columns(found, run.elements)
    except ForeignElement as error:
        raise Failure(f"{path}: {error}") from error
    except (KeyError, ValueError, TypeError) as error:
        raise Failure(f"{path}: its description of the run is unreadable ({error})") from error
    if undescribed:
        raise Failure(f"{path}: damaged: columns and description do not agree about {', '.join(undescribed)}")
    return run


def _check_columns(path: Path, found: pa.Schema, output: pa.DataType) -> None:
    """Refuse columns that are no signals and not known, lack what no recording does without, or have another type."""
    here = schema()
    try:
        names = found.names
    except UnicodeDecodeError as error:
        raise Failure(f"{path}: a column's name is damaged") from error
    for name in ("tick", "deadline_ns", "frames"):
        if name not in names:
            raise Failure(f"{path}: it has no column {name}")
    for column in found:
        kinds = {"out.": output, "in.": pa.float64(), "status.": pa.float64()}
        kind = next((kinds[prefix] for prefix in kinds if column.name.startswith(prefix)), None)
        if kind is None and column.name not in here.names:
            raise Failure(f"{path}: this version does not know its column {column.name}")
        if names.count(column.name) > 1 or column.type != (kind or here.field(column.name).type):
            raise Failure(f"{path}: its column {column.name} is not as this version writes it")


def matrix(rows: pa.RecordBatch, names: tuple[str, ...]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return some columns as an array of one row for each tick; nulls become NaN."""
    columns = [rows.column(name).to_numpy(zero_copy_only=False) for name in names]
    return np.ascontiguousarray(np.stack(columns, axis=1), dtype=np.float64)


def _text(stored: bytes) -> str:
    return stored.decode(errors="replace")  # damage is for the checksum to find


def _first_line(error: Exception) -> str:
    return str(error).strip().partition("\n")[0] or type(error).__name__
