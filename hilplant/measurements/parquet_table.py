"""The columns of a Parquet file that are numbers, dates, times of the day or durations; text as in a CSV file."""

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.measurements.csv_layout import kind_of_column
from hilplant.measurements.csv_table import Table, converted, since_first
from hilplant.units import FACTORS


def read_parquet(path: Path) -> Table:
    """Read the numbers of a Parquet file; null is NaN, dates are seconds, yes and no are 1 and 0.

    Columns of other text are left out. Lines are rows here, counted from 1.

    Raises
    ------
    Failure
        When it is no Parquet file, or naming the row of a text that is no number in a column of such.

    """
    try:
        table = parquet.read_table(path)
    except (pa.ArrowException, OSError, MemoryError) as error:
        raise Failure(f"{path}: not a Parquet file: {str(error).splitlines()[0]}") from error
    columns, units, texts = {}, {}, {}
    for field in table.schema:
        try:
            found = _column(path, table.column(field.name))
        except (ValueError, TypeError):
            continue  # neither numbers nor text
        if found is None:
            texts[field.name] = str(next(iter(table.column(field.name).to_pylist()), ""))
            continue
        columns[field.name], in_seconds = found
        unit = (field.metadata or {}).get(b"unit", b"").decode("utf-8", "replace")
        units[field.name] = "s" if in_seconds else unit
    return Table(columns, units, 1, None, texts)


def _column(path: Path, column: Any) -> tuple[Floats, bool] | None:
    """Return a column as numbers, and whether these are seconds; None for text."""
    if pa.types.is_dictionary(column.type):
        column = column.cast(column.type.value_type)
    kind = column.type
    if pa.types.is_string(kind) or pa.types.is_large_string(kind):
        return _text(path, [cell or "" for cell in column.to_pylist()])
    if pa.types.is_time(kind):
        ticks = column.cast(pa.int64() if pa.types.is_time64(kind) else pa.int32()).to_numpy()
        return since_first(np.zeros(len(ticks)), ticks * FACTORS["s"][kind.unit]), True
    values = column.to_numpy()
    if values.dtype.kind not in "mM" or not len(values):
        return np.asarray(values, np.float64), False
    first = values[np.argmax(~np.isnat(values))]
    since = (values - first if values.dtype.kind == "M" else values).astype("timedelta64[ns]")
    return np.where(np.isnat(since), np.nan, since.astype(np.int64) * 1e-9), True


def _text(path: Path, cells: list[str]) -> tuple[Floats, bool] | None:
    kind = kind_of_column(cells, ".")
    return (converted(path, list(cells), kind, ".", 1), kind == "date") if kind in ("number", "date") else None
