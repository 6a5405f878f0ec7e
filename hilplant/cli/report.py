"""Prints a report: tables and lines, 132 columns wide."""

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from hilplant.thesis.text_table import Part, TextTable

_STYLES = {"yes": "green", "NO": "bold red"}


def print_report(parts: Sequence[Part]) -> None:
    """Print tables and lines in their order."""
    console = Console(width=132, highlight=False, markup=False)
    for part in parts:
        console.print(_drawn(part) if isinstance(part, TextTable) else part)


def _drawn(shown: TextTable) -> Table:
    table = Table(title=shown.title or None, title_justify="left", box=None, pad_edge=False)
    first, *others = shown.columns
    table.add_column(first)
    for column in others:
        table.add_column(column, justify="right" if shown.numbers else "left")
    for row in shown.rows:
        style = "dim" if row[0].startswith("  ") else ""
        table.add_row(*(Text(cell, _STYLES.get(cell, "")) for cell in row), style=style)
    return table
