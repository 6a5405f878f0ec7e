"""How a table is written: separator, decimal sign, where its rows begin, names and units of its columns.

The rows decide, not the header: most lines of a table are rows, and all rows hold the same kinds of cells.
"""

import csv
import re
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from hilplant.measurements.cells import in_thousands, is_unit, kind_of
from hilplant.units import unit_of

#: Separator and decimal sign, in the order in which they are tried; the first of equals is taken.
WRITINGS = ((",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ","), (",", ","), ("|", "."), (" ", "."))
#: Rows that are looked at to tell the kinds of columns.
SAMPLED = 400
_UNIT = re.compile(r"[\[(]\s*(?P<unit>[^\])]*?)\s*[\])]\s*$")
_AFTER = re.compile(r"(?:^|\s)(?:/|in\b)\s*(?P<unit>\S+)\s*$")
_START = re.compile(r"(t0|start|x0|x_?origin|xzero|start time)", re.IGNORECASE)
_STEP = re.compile(r"(t_?inc|increment|x_?increment|delta_x|sample interval|sample period|dt)", re.IGNORECASE)
_NO_UNIT = ("[]", "[-]", "()", "(-)")
_EQUALS = re.compile(r"\s*(?P<name>[A-Za-z_0-9 ]+?)\s*=\s*(?P<value>[-+]?[0-9.]+([eE][-+]?\d+)?)\s*s?\s*")


class Layout(NamedTuple):
    """`kinds` are those of the columns: number, date, text or "" for one that is empty.

    `clock` is start and distance of the samples [s] where the head says them; `texts` are columns of text with what
    stands in their first row.
    """

    separator: str
    decimal: str
    first_row: int  # line index of the first row
    names: tuple[str, ...]
    units: tuple[str, ...]
    kinds: tuple[str, ...]
    clock: tuple[float, float] | None
    texts: dict[str, str]


class _Rows(NamedTuple):
    first: int
    matching: int
    kinds: tuple[str, ...]
    doubtful: int  # columns whose numbers look as if the other decimal sign were meant


def layout_of(head: Sequence[str]) -> Layout | None:
    """Find the writing that gives the most numbers and least text; None where there is no table.

    Where both decimal signs fit, as for 1,250 beside 12,500, that one is taken which leaves fewer columns doubtful.
    """
    best, most = None, (0, 0, 0)
    for separator, decimal in WRITINGS:
        lines = list(split(head, separator))
        rows = _rows(lines, decimal)
        if rows is None:
            continue
        numbers = sum(kind in ("number", "date") for kind in rows.kinds)
        size = rows.matching * numbers, -rows.kinds.count("text"), -rows.doubtful
        if numbers and size > most:
            names, units, clock = _header(lines[: rows.first], lines[rows.first :], rows.kinds)
            cells = zip(names, rows.kinds, lines[rows.first], strict=True)
            texts = {name: cell for name, kind, cell in cells if kind == "text"}
            best, most = Layout(separator, decimal, rows.first, names, units, rows.kinds, clock, texts), size
    return best


def split(lines: Sequence[str], separator: str) -> list[list[str]]:
    """Split lines into cells, quoted ones too; each line by itself. Blanks separate as one, however many."""
    found = []
    for line in map(with_single_blanks, lines) if separator == " " else lines:
        try:
            cells = next(csv.reader([line], delimiter=separator, skipinitialspace=separator != " "), [])
        except csv.Error:
            cells = line.split(separator)
        found.append([cell.strip() for cell in cells])
    return found


def with_single_blanks(text: str) -> str:
    """Return lines without blanks at their ends, and with one blank where there are more."""
    return re.sub(r"(?m)^ +| +$", "", re.sub(" {2,}", " ", text))


def _rows(lines: list[list[str]], decimal: str) -> _Rows | None:
    widths = Counter(len(cells) for cells in lines if len(cells) > 1 and any(cells))
    if not widths:
        return None
    width = max(widths, key=lambda each: (widths[each], each))
    same = [(place, cells) for place, cells in enumerate(lines) if len(cells) == width]
    columns = [[cells[column] for _, cells in same] for column in range(width)]
    kinds = [kind_of_column(cells, decimal) for cells in columns]
    numbers = [cells for cells, kind in zip(columns, kinds, strict=True) if kind == "number"]
    doubtful = sum(_doubtful(cells[:: max(1, len(cells) // SAMPLED)], decimal) for cells in numbers)
    matching = [place for place, cells in same if _fits(cells, kinds, decimal)]
    if not matching or not {"number", "date"} & set(kinds):
        return None
    kinds = [kind or _sparse_kind(same, matching[0], at, decimal) for at, kind in enumerate(kinds)]
    return _Rows(matching[0], len(matching), tuple(kinds), doubtful)


def _doubtful(cells: list[str], decimal: str) -> bool:
    """Say whether the other decimal sign is the likelier one for a column of numbers.

    As thousands, where each number is as 12,345: a table with three decimals. As decimals, where some are so and all
    others are below a thousand and have none: a table whose thousands are marked.
    """
    written = [cell for cell in cells if any(sign.isdigit() for sign in cell)]
    marked = [cell for cell in written if in_thousands(cell, decimal)]
    if marked:
        return len(marked) == len(written)
    other = "." if decimal == "," else ","
    marked = [cell for cell in written if in_thousands(cell, other)]
    others = [cell for cell in written if not in_thousands(cell, other)]
    return len(marked) > 0 and len(others) > 0 and all(cell.lstrip("+-").isdecimal() for cell in others)


def _sparse_kind(same: list[tuple[int, list[str]]], first: int, column: int, decimal: str) -> str:
    """Return the kind of a column that is mostly empty, as of a signal that is written when it changes."""
    kinds = {kind_of(cells[column], decimal) for place, cells in same if place >= first} - {""}
    return "number" if kinds == {"number"} else ""


def kind_of_column(cells: Sequence[str], decimal: str) -> str:
    """Return the kind of most cells: number, date or text; "" for a column with next to nothing in it."""
    seen = Counter(kind_of(cell, decimal) for cell in cells[:: max(1, len(cells) // SAMPLED)])
    empty = seen.pop("", 0)
    common = max(seen, key=lambda kind: (seen[kind], kind != "text"), default="")
    return common if seen[common] * 10 > empty else ""


def _fits(cells: list[str], kinds: list[str], decimal: str) -> bool:
    """Say whether a line is a row: at least one number or date, and none of its cells of another kind."""
    found = False
    for cell, kind in zip(cells, kinds, strict=True):
        if kind in ("number", "date") and (own := kind_of(cell, decimal)):
            if own != kind:
                return False
            found = True
    return found


def _header(
    above: list[list[str]], rows: list[list[str]], kinds: tuple[str, ...]
) -> tuple[tuple[str, ...], tuple[str, ...], tuple[float, float] | None]:
    """Return names and units of the columns, and the clock of the samples where the lines above say it."""
    width = len(kinds)
    lines = [cells for cells in above if any(cells)]
    clock = _clock(lines)
    units = [""] * width
    if lines and _is_units(lines[-1], width) and len(lines) > 1:
        units = [unit_of(cell) if is_unit(cell) or cell[:1] in "[(" else "" for cell in _wide(lines.pop(), width)]
    else:
        for cells in lines[:-1]:
            if cells[0].lower() in ("vertical units", "units", "unit", "einheit", "einheiten"):
                units = ["", *(unit_of(cell) for cell in _wide(cells, width)[1:])]
            elif cells[0].lower() == "horizontal units" and len(cells) > 1:
                units[0] = unit_of(cells[1])
    names = lines[-1] if lines and len(lines[-1]) >= width - (rows[0][-1] == "") and len(lines[-1]) > 1 else []
    names = _wide(names[1:] if names[:1] == ["#"] else names, width)  # a comment's sign is no column
    found = [_name_and_unit(name, unit) for name, unit in zip(names, units, strict=True)]
    named = [name or f"column{index + 1}" for index, (name, _) in enumerate(found)]
    unique = [name if named.index(name) == index else f"{name}.{index + 1}" for index, name in enumerate(named)]
    return tuple(unique), tuple(unit for _, unit in found), clock


def _wide(cells: list[str], width: int) -> list[str]:
    return [*cells, *([""] * width)][:width]


def _is_units(cells: list[str], width: int) -> bool:
    """Say whether a line is one of units: nothing but such words, brackets and dashes, and one of them at least."""
    written = [cell for cell in _wide(cells, width) if kind_of(cell, ".") == "text" and cell not in _NO_UNIT]
    return bool(written) and all(is_unit(cell) or (cell[0] in "[(" and cell[-1] in "])") for cell in written)


def _name_and_unit(name: str, unit: str) -> tuple[str, str]:
    if found := _UNIT.search(name):
        return _UNIT.sub("", name).strip(), unit_of(found["unit"])
    after = _AFTER.search(name)
    if after and is_unit(after["unit"]):
        return _AFTER.sub("", name).strip(), unit_of(after["unit"])
    return name, unit


def _clock(lines: list[list[str]]) -> tuple[float, float] | None:
    """Find start and distance of the samples: in cells below their names, beside them, or behind an equals sign."""
    found: dict[str, float] = {}
    for line, below in zip(lines, [*lines[1:], []], strict=False):
        for place, cell in enumerate(line):
            equal = _EQUALS.fullmatch(cell)
            name = equal["name"] if equal else cell
            values = [equal["value"]] if equal else [*below[place : place + 1], *line[place + 1 : place + 2]]
            for key, pattern in (("start", _START), ("step", _STEP)):
                if pattern.fullmatch(name.strip()):
                    numbers = [float(value) for value in values if kind_of(value, ".") == "number"]
                    found |= {key: numbers[0]} if numbers else {}
    return (found.get("start", 0.0), found["step"]) if found.get("step", 0.0) > 0.0 else None
