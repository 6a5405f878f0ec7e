"""Reads what `write_table` has written: columns of numbers from .csv or .parquet, or a recording's signals."""

from pathlib import Path

import numpy as np

from hilplant.arrays import Floats
from hilplant.extras import need
from hilplant.failure import Failure


def read_table(path: Path) -> dict[str, Floats]:
    """Return the columns by name, in the order of the file.

    Raises
    ------
    Failure
        When the file cannot be read, with its line where there is one.

    """
    readers = {".csv": _csv, ".parquet": _parquet, ".hilrec": _recording}
    ending = path.suffix.lower()
    if ending not in readers:
        raise Failure(f"{path}: the ending must be one of {', '.join(readers)}")
    try:
        return readers[ending](path)
    except OSError as error:
        raise Failure(f"{path}: cannot be read: {(error.strerror or str(error)).lower()}") from error


def _csv(path: Path) -> dict[str, Floats]:
    with path.open(encoding="utf-8", errors="replace") as file:
        names = file.readline().strip().split(",")
        rows = []
        for number, line in enumerate(file, start=2):
            cells = line.split(",")
            if len(cells) != len(names):
                raise Failure(f"{path}:{number}: has {len(cells)} columns, the first line {len(names)}")
            try:
                rows.append([float(cell) for cell in cells])
            except ValueError:
                raise Failure(f"{path}:{number}: is no row of numbers") from None
    values = np.array(rows, dtype=np.float64).reshape(len(rows), len(names))
    return {name: values[:, index] for index, name in enumerate(names)}


def _parquet(path: Path) -> dict[str, Floats]:
    need("recording")
    import pyarrow as pa
    from pyarrow import parquet

    try:
        table = parquet.read_table(path)
        return {name: np.asarray(table.column(name).to_numpy(), np.float64) for name in table.column_names}
    except (pa.ArrowException, ValueError, TypeError) as error:
        raise Failure(f"{path}: not a table of numbers: {str(error).splitlines()[0]}") from error


def _recording(path: Path) -> dict[str, Floats]:
    need("recording")
    from hilplant.recording.export import signal_columns
    from hilplant.recording.reader import read_recording

    return dict(signal_columns(read_recording(path))[0])
