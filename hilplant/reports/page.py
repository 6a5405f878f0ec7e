"""A report as a page in Markdown, and what it says in a terminal."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from hilplant.atomic_write import write_text


class TrainingReport(NamedTuple):
    """What a fit came to: lines for a terminal, figures by flat names, and whether it kept what its file states."""

    lines: list[str]
    figures: dict[str, Any]
    kept: bool = True


def write_page(folder: Path, title: str, sections: Sequence[str]) -> Path:
    """Write `report.md`: a title and sections with a blank line between them."""
    page = folder / "report.md"
    write_text(page, "\n\n".join([f"# {title}", *sections]) + "\n")
    return page


def markdown_table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(_shown(cell) for cell in line)} |" for line in lines)


def _shown(cell: object) -> str:
    return f"{cell:.4g}" if isinstance(cell, float) else str(cell)
