"""Measures, and prints the figures as a table that fits 100 columns."""

from typing import Literal

from rich.console import Console
from rich.table import Table

from hilplant.cli.progress import progress_shown
from hilplant.perf.perf import measure
from hilplant.perf.results import PartResult, Row

_WIDTH = 100
_COLUMNS: tuple[tuple[str, Literal["left", "right"]], ...] = (
    ("part", "left"),
    ("figure", "left"),
    ("measured", "right"),
    ("limit in the same run", "right"),
    ("ratio", "right"),
    ("goal", "left"),
)


def amount(value: float, unit: str) -> str:
    """Return a figure with three significant digits or more, and its unit."""
    digits = 0 if abs(value) >= 100 else 1 if abs(value) >= 10 else 2 if abs(value) >= 1 else 3
    return f"{value:.{digits}f} {unit}"


def goal_text(row: Row) -> str:
    """Return the goal and whether it was reached, in words and not in colour alone."""
    if row.goal is None:
        return ""
    goal = f"{row.goal.at_most:g}" if row.goal.of_ratio else f"{row.goal.at_most:g} {row.unit}"
    return f"{'yes' if row.met else 'NO'}, {goal}"


def measure_and_print(only: str | None = None) -> dict[str, float | str]:
    """Measure the parts in `only`, or all; print each figure beside its limit and return the figures."""
    with progress_shown() as on_progress:
        found = measure(only, on_progress)
    title = "{}, {} cores; {}; Python {}; numba {}; load before {}".format(*found.machine.values())
    print_table(found.parts, title)
    return found.figures


def print_table(parts: dict[str, PartResult], title: str) -> None:
    """Print every part's rows, then its remarks."""
    table = Table(title=title, title_justify="left", width=_WIDTH)
    for name, justify in _COLUMNS:
        table.add_column(name, justify=justify)
    for part, measured in parts.items():
        for index, row in enumerate(measured.rows):
            table.add_row("" if index else part, *_cells(row))
        table.add_section()
    console = Console(width=_WIDTH, highlight=False)
    console.print(table)
    for part, measured in parts.items():
        for remark in measured.remarks:
            console.print(f"{part}: {remark}", markup=False)


def _cells(row: Row) -> list[str]:
    limit = "" if row.limit is None else f"{row.limit_name} {amount(row.limit, row.unit)}"
    ratio = "" if row.ratio is None else f"{row.ratio:.2f}"
    style = {True: "green", False: "bold red", None: "default"}[row.met]
    goal = goal_text(row)
    return [row.what, amount(row.value, row.unit), limit, ratio, f"[{style}]{goal}[/]" if goal else ""]
