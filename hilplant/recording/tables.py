"""Columns of numbers over time -> a file, in the format that its ending names: .csv, .parquet or .mf4."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from hilplant.atomic_write import whole_file
from hilplant.extras import need
from hilplant.failure import Failure

#: Rows that are turned into text at once.
_CHUNK = 4096

Columns = Mapping[str, NDArray[np.float64]]


class TableError(Failure):
    """A table cannot be written like this; the message says how it can."""


def write_table(path: str | Path, columns: Columns, units: Mapping[str, str]) -> None:
    """Write columns of equal length, the first of which is the time [s]; `units` by column, "" for none.

    The file is written whole or not at all. Numbers keep every digit: what is read back is bit for bit what was
    written.

    Raises
    ------
    TableError
        When the ending is not known, its library is not installed, or the file cannot be written.

    """
    check_ending(path)
    try:
        with whole_file(Path(path)) as passing:
            fill_table(passing, columns, units)
    except OSError as error:
        raise TableError(f"{path}: cannot be written: {error.strerror or error}") from error


def fill_table(path: Path, columns: Columns, units: Mapping[str, str]) -> None:
    """Write columns as `write_table` does, in place; a failure is an OSError and leaves half a file."""
    _WRITERS[path.suffix.lower()](path, columns, units)


def check_ending(path: str | Path) -> None:
    """Say before any work is done whether a file with this name could be written."""
    ending = Path(path).suffix.lower()
    if ending not in _WRITERS:
        raise TableError(f"{path}: the ending must be one of {', '.join(_WRITERS)}")
    if ending == ".mf4":
        need("mdf")
    if ending == ".parquet":
        need("recording")


def _write_csv(path: Path, columns: Columns, units: Mapping[str, str]) -> None:
    with path.open("wb") as file:
        file.write((",".join(columns) + "\n").encode())
        rows = np.stack(list(columns.values()), axis=1)
        for first in range(0, len(rows), _CHUNK):
            # As JSON: the shortest digits that read back the same, ten times as fast as repr().
            text = to_json(rows[first : first + _CHUNK].tolist(), inf_nan_mode="constants")
            lines = text[2:-2].replace(b"],[", b"\n") + b"\n"
            file.write(lines.replace(b".0,", b",").replace(b".0\n", b"\n"))


def _write_parquet(path: Path, columns: Columns, units: Mapping[str, str]) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    fields = [pa.field(name, pa.float64(), metadata={"unit": units.get(name, "")}) for name in columns]
    parquet.write_table(pa.table(list(columns.values()), schema=pa.schema(fields)), path)


def _write_mf4(path: Path, columns: Columns, units: Mapping[str, str]) -> None:
    import asammdf

    names = list(columns)
    time_s = columns[names[0]]
    signals = [asammdf.Signal(columns[name], time_s, name=name, unit=units.get(name, "")) for name in names[1:]]
    with asammdf.MDF(version="4.10") as file:
        file.append(signals, comment="hilplant", common_timebase=True)
        file.save(path, overwrite=True, compression=2)


_WRITERS: dict[str, Callable[[Path, Columns, Mapping[str, str]], None]] = {
    ".csv": _write_csv,
    ".parquet": _write_parquet,
    ".mf4": _write_mf4,
}
