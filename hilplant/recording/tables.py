"""Columns of numbers over time -> a file, in the format that its ending names: .csv, .parquet, .mf4 or .mcap."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from pydantic_core import to_json

from hilplant.arrays import Floats
from hilplant.atomic_write import cannot_be_written, whole_file
from hilplant.extras import need
from hilplant.failure import Failure
from hilplant.recording.mcap_table import mcap_table

#: Rows that are turned into text at once.
_CHUNK = 4096

Columns = Mapping[str, Floats]
#: Takes more rows of a table: columns of equal length, the same each time.
Add = Callable[[Columns], None]


class TableError(Failure):
    """A table cannot be written like this; the message says how it can."""


def write_table(path: str | Path, columns: Columns, units: Mapping[str, str]) -> None:
    """Write columns of equal length, the first of which is the time [s]; `units` by column, "" for none.

    The file is written whole or not at all. Numbers keep every digit: what is read back is bit for bit what was
    written.

    Raises
    ------
    TableError
        When the ending is not known.
    Failure
        When its library is not installed, or the file cannot be written.

    """
    check_ending(path)
    try:
        with whole_file(Path(path)) as passing, open_table(passing, units) as add:
            add(columns)
    except OSError as error:
        raise cannot_be_written(Path(path), error) from error


def open_table(path: Path, units: Mapping[str, str]) -> AbstractContextManager[Add]:
    """Write as `write_table` does, in place and piece by piece; a failure is an OSError and leaves half a file."""
    return _WRITERS[path.suffix.lower()](path, units)


def check_ending(path: str | Path) -> None:
    """Say before any work is done whether a file with this name could be written."""
    ending = Path(path).suffix.lower()
    if ending not in _WRITERS:
        raise TableError(f"{path}: the ending must be one of {', '.join(_WRITERS)}")
    if ending == ".mf4":
        need("mdf")
    if ending == ".parquet":
        need("recording")
    if ending == ".mcap":
        need("mcap")


@contextmanager
def _csv_table(path: Path, _: Mapping[str, str]) -> Iterator[Add]:
    with path.open("wb") as file:

        def add(columns: Columns) -> None:
            if not file.tell():
                file.write((",".join(columns) + "\n").encode())
            rows = np.stack(list(columns.values()), axis=1)
            for first in range(0, len(rows), _CHUNK):
                # As JSON: the shortest digits that read back the same, ten times as fast as repr().
                text = to_json(rows[first : first + _CHUNK].tolist(), inf_nan_mode="constants")
                lines = text[2:-2].replace(b"],[", b"\n") + b"\n"
                file.write(lines.replace(b".0,", b",").replace(b".0\n", b"\n"))

        yield add


@contextmanager
def _parquet_table(path: Path, units: Mapping[str, str]) -> Iterator[Add]:
    import pyarrow as pa
    from pyarrow import parquet

    writer: parquet.ParquetWriter | None = None

    def add(columns: Columns) -> None:
        nonlocal writer
        if writer is None:
            fields = [pa.field(name, pa.float64(), metadata={"unit": units.get(name, "")}) for name in columns]
            writer = parquet.ParquetWriter(path, pa.schema(fields))
        writer.write_table(pa.table(list(columns.values()), schema=writer.schema))

    try:
        yield add
    finally:
        if writer is not None:
            writer.close()


@contextmanager
def _mf4_table(path: Path, units: Mapping[str, str]) -> Iterator[Add]:
    import asammdf

    with asammdf.MDF(version="4.10") as file:
        yield mf4_group(file, units)
        file.save(path, overwrite=True, compression=2)


def mf4_group(file: Any, units: Mapping[str, str]) -> Add:
    """Return what adds rows to one group of an open MF4 file; the first column is its time."""
    import asammdf

    group: int | None = None

    def add(columns: Columns) -> None:
        nonlocal group
        time_s, *values = columns.values()
        if group is None:
            names = list(columns)[1:]
            signals = [
                asammdf.Signal(column, time_s, name=name, unit=units.get(name, ""))
                for name, column in zip(names, values, strict=True)
            ]
            group = file.append(signals, comment="hilplant", common_timebase=True)
        elif len(time_s):
            file.extend(group, [(time_s, None), *((column, None) for column in values)])

    return add


_WRITERS: dict[str, Callable[[Path, Mapping[str, str]], AbstractContextManager[Add]]] = {
    ".csv": _csv_table,
    ".parquet": _parquet_table,
    ".mf4": _mf4_table,
    ".mcap": mcap_table,
}
