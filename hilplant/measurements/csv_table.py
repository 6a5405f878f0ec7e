"""A CSV file as instruments write it: three separators, decimal commas, lines before the header, a line of units."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa
from pyarrow import csv

from hilplant.failure import Failure
from hilplant.measurements.measurement import Samples

#: Lines in which header, separator and decimal sign are looked for.
_HEAD_LINES = 5000
_UNIT = re.compile(r"[\[(]\s*(?P<unit>[^\])]*?)\s*[\])]\s*$")
_ROW = re.compile(r"Row #(\d+)")


class _Layout(NamedTuple):
    separator: str
    decimal: str
    first_row: int  # line index of the first row of numbers
    names: tuple[str, ...]
    units: tuple[str, ...]


class Table(NamedTuple):
    """Columns by name, their units as written ("" for none), and the line number of the first row of numbers."""

    columns: dict[str, Samples]
    units: dict[str, str]
    first_line: int


def read_csv(path: Path) -> Table:
    """Read the numbers of a CSV file; an empty cell is NaN.

    Raises
    ------
    Failure
        Naming the line that is wrong.

    """
    with open(path, encoding="utf-8-sig", errors="replace") as file:
        head = [line.rstrip("\r\n") for _, line in zip(range(_HEAD_LINES), file, strict=False)]
    if not any(head):
        raise Failure(f"{path}: is empty")
    layout = _layout(head)
    if layout is None:
        raise Failure(f"{path}: no table of numbers found in its first {len(head)} lines; separators are , ; and tab")
    try:
        table = csv.read_csv(
            path,
            csv.ReadOptions(skip_rows=layout.first_row, column_names=list(layout.names), use_threads=False),
            csv.ParseOptions(delimiter=layout.separator),
            csv.ConvertOptions(
                decimal_point=layout.decimal,
                column_types=dict.fromkeys(layout.names, pa.float64()),
                null_values=["", "NaN", "nan", "NA"],
            ),
        )
    except pa.ArrowInvalid as error:
        raise Failure(f"{path}{_line(str(error))}: {_reason(str(error), len(layout.names))}") from error
    columns = {name: np.asarray(table.column(name).to_numpy(), np.float64) for name in layout.names}
    return Table(columns, dict(zip(layout.names, layout.units, strict=True)), layout.first_row + 1)


def _layout(head: Sequence[str]) -> _Layout | None:
    """Find separator, decimal sign and the first row of numbers: those that give the most columns, then rows.

    The rows decide where the first ones hold whole numbers only.
    """
    best, most = None, (0, 0)
    for separator, decimal in ((",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ",")):
        first = next((index for index, line in enumerate(head) if _is_row(line, separator, decimal)), None)
        if first is None:
            continue
        names, units = _header(head, first, separator)
        size = len(names), sum(_is_row(line, separator, decimal) for line in head)
        if size > most:
            best, most = _Layout(separator, decimal, first, names, units), size
    return best


def _is_row(line: str, separator: str, decimal: str) -> bool:
    cells = [cell.strip() for cell in line.split(separator)]
    return len(cells) > 1 and any(cells) and all(not cell or _is_number(cell, decimal) for cell in cells)


def _is_number(cell: str, decimal: str) -> bool:
    if decimal == "," and "." in cell:
        return False
    try:
        float(cell.replace(decimal, "."))
    except ValueError:
        return False
    return True


def _header(head: Sequence[str], first: int, separator: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return names and units of the columns; without a header the names are column1, column2, ..."""
    width = len(head[first].split(separator))
    above = [[cell.strip().strip('"') for cell in line.split(separator)] for line in head[:first] if line.strip()]
    rows = [row for row in above[-2:] if len(row) == width]
    written = [""] * width
    if len(rows) == 2 and all(len(cell) <= 6 for cell in rows[1]) and not any(_UNIT.search(cell) for cell in rows[0]):
        written = [cell.strip("[]() ") for cell in rows.pop()]
    names = rows[-1] if rows else [""] * width
    pairs = zip(names, written, strict=True)
    units = [found["unit"] if (found := _UNIT.search(name)) else unit for name, unit in pairs]
    names = [_UNIT.sub("", name).strip() or f"column{index + 1}" for index, name in enumerate(names)]
    unique = [name if names.index(name) == index else f"{name}.{index + 1}" for index, name in enumerate(names)]
    return tuple(unique), tuple(units)


def _line(text: str) -> str:
    """Return the line that pyarrow complains of; it counts the file's lines from 1."""
    found = _ROW.search(text)
    return f":{found[1]}" if found else ""


def _reason(text: str, width: int) -> str:
    if found := re.search(r"invalid value '([^']*)'", text):
        return f"'{found[1]}' is not a number"
    if found := re.search(r"Expected \d+ columns, got (\d+)", text):
        return f"has {found[1]} columns where the first row has {width}"
    return " ".join(text.split())
