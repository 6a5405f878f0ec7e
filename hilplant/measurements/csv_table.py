"""A CSV file as instruments and spreadsheets write it: any usual encoding, separator, decimal sign and header."""

import io
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa
from pyarrow import csv

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.measurements.cells import moment_of, number_of
from hilplant.measurements.csv_layout import Layout, layout_of, with_single_blanks

#: Lines in which header, separator and decimal sign are looked for, and characters of one line that are looked at.
_HEAD_LINES, _LONGEST_LINE = 5000, 20_000
#: Characters in which that many lines are looked for.
_LONGEST_HEAD = 10_000_000
#: A quoted cell of two to four short lines.
_BROKEN = re.compile(r'(?m)(?:^|(?<=[,;\t|]))"[^"\n]{0,100}(?:\n[^"\n]{0,100}){1,3}"(?=[,;\t|\n])')
_ROW = re.compile(r"Row #(\d+)")
_COLUMN = re.compile(r"CSV column #(\d+)")


class Table(NamedTuple):
    """Columns by name, their units as written ("" for none), and the line number of the first row of numbers.

    `clock` is start and distance of the samples [s] where the head says them; `texts` are columns that are left out
    because they hold text, with what stands in their first row.
    """

    columns: dict[str, Floats]
    units: dict[str, str]
    first_line: int
    clock: tuple[float, float] | None
    texts: dict[str, str]


def read_csv(path: Path) -> Table:
    """Read the numbers of a CSV file; an empty cell is NaN, dates are seconds, yes and no are 1 and 0.

    Columns of text are left out.

    Raises
    ------
    Failure
        Naming the line that is wrong.

    """
    text = _unbroken(_decoded(path.read_bytes()))
    head = [line[:_LONGEST_LINE] for line in text[:_LONGEST_HEAD].removesuffix("\n").split("\n")[:_HEAD_LINES]]
    if not any(head):
        raise Failure(f"{path}: is empty")
    layout = layout_of(head)
    if layout is None:
        raise Failure(f"{path}: no table of numbers found in its first {len(head)} lines; separators are , ; | and tab")
    content = (with_single_blanks(text) if layout.separator == " " else text).encode()
    del text  # of a long file, each copy counts
    kinds = {name: kind for name, kind in zip(layout.names, layout.kinds, strict=True) if kind in ("number", "date")}
    as_text = {name for name, kind in kinds.items() if kind == "date"}
    while True:  # each round finds one more column that pyarrow cannot read as numbers
        try:
            table = _parsed(content, layout, as_text)
            break
        except pa.ArrowInvalid as error:
            column = _COLUMN.search(str(error))
            name = layout.names[int(column[1])] if column else ""
            if name not in kinds or name in as_text:
                raise Failure(f"{path}{_line(str(error))}: {_reason(str(error), len(layout.names))}") from error
            as_text.add(name)
    columns = {}
    for name, kind in kinds.items():
        cells = table.column(name)
        if name in as_text:
            columns[name] = converted(path, cells.to_pylist(), kind, layout.decimal, layout.first_row + 1)
        else:
            columns[name] = np.asarray(cells.to_numpy(), np.float64)
    units = dict(zip(layout.names, layout.units, strict=True))
    units |= {name: "s" for name in kinds if kinds[name] == "date"}
    return Table(columns, units, layout.first_row + 1, layout.clock, layout.texts)


def _decoded(content: bytes) -> str:
    """Decode by the mark at the beginning, else as UTF-8, else as a Western Windows does; one kind of line ends."""
    encodings = ["utf-8-sig", "cp1252"]
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        encodings = ["utf-16"]
    elif b"\0" in content[:200]:
        encodings = ["utf-16-le" if content[1:2] == b"\0" else "utf-16-be"]
    text = None
    for encoding in encodings:
        try:
            text = content.decode(encoding)
            break
        except UnicodeDecodeError:
            continue
    text = content.decode(encodings[-1], "replace") if text is None else text
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _unbroken(text: str) -> str:
    """Return a text whose quoted names have blanks for line breaks; empty lines before it keep the count of lines."""
    head = text[:_LONGEST_LINE]
    joined = _BROKEN.sub(lambda found: found[0].replace("\n", " "), head)
    breaks = head.count("\n") - joined.count("\n")
    return "\n" * breaks + joined + text[_LONGEST_LINE:] if breaks else text


def _parsed(content: bytes, layout: Layout, as_text: set[str]) -> pa.Table:
    kinds = zip(layout.names, layout.kinds, strict=True)
    numbers = {name for name, kind in kinds if kind == "number" and name not in as_text}
    types = {name: pa.float64() if name in numbers else pa.string() for name in layout.names}
    return csv.read_csv(
        io.BytesIO(content),
        csv.ReadOptions(skip_rows=layout.first_row, column_names=list(layout.names), use_threads=False),
        csv.ParseOptions(delimiter=layout.separator),
        csv.ConvertOptions(
            decimal_point=layout.decimal, column_types=types, null_values=["", "NaN", "nan", "NA"],
            check_utf8=False,
        ),
    )  # fmt: skip


def converted(path: Path, cells: list[str | None], kind: str, decimal: str, first_line: int) -> Floats:
    """Read the cells of a column one by one, shape (rows,); dates in seconds from the first, NaN for an empty cell.

    Raises
    ------
    Failure
        Naming the line of a cell that is not of this kind: number or date.

    """
    values = np.full((len(cells), 2), np.nan)  # days, and seconds or the number itself
    for index, cell in enumerate(cells):
        number = number_of(cell or "", decimal)
        plain = (0, number) if number is not None and (kind == "number" or np.isnan(number)) else None
        value = plain or (moment_of(cell or "") if kind == "date" else None)
        if value is None:
            what = "a number" if kind == "number" else "a time"
            raise Failure(f"{path}:{first_line + index}: '{_shown(cell or '')}' is not {what}")
        values[index] = value
    days, seconds = values.T
    return seconds if kind == "number" else since_first(days, seconds)


def since_first(days: Floats, seconds: Floats) -> Floats:
    """Return seconds from the first moment that is there; a time of the day alone goes on behind midnight."""
    there = np.isfinite(seconds)
    if not there.any():
        return seconds
    if not np.any(days):
        days = np.zeros(len(seconds))
        days[there] = np.concatenate([[0.0], np.cumsum(np.diff(seconds[there]) < -43200.0)])
    first = int(np.argmax(there))
    return np.asarray((days - days[first]) * 86400.0 + seconds - seconds[first], np.float64)


def _shown(text: str) -> str:
    """Return a text in one line that is not longer than a message may be."""
    return " ".join(text.split())[:120]


def _line(text: str) -> str:
    """Return the line that pyarrow complains of; it counts the file's lines from 1."""
    found = _ROW.search(text)
    return f":{found[1]}" if found else ""


def _reason(text: str, width: int) -> str:
    if found := re.search(r"invalid value '([^']*)'", text):
        return f"'{_shown(found[1])}' is not a number"
    if found := re.search(r"Expected \d+ columns, got (\d+)", text):
        return f"has {found[1]} columns where the first row has {width}"
    return _shown(text)
