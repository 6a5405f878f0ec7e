"""A table as the studies return it: the command line decides how."""

from collections.abc import Sequence
from typing import NamedTuple


class TextTable(NamedTuple):
    """A title, column heads and rows of cells; `numbers` says that all but the first column are numbers."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    numbers: bool = False


#: A part of a report: a table, or a line.
Part = TextTable | str


def yes_or_no(holds: bool) -> str:
    """Return a word that a reader finds when it is the bad one."""
    return "yes" if holds else "NO"
