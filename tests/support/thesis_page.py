"""The table of docs/thesis.md, and the commands that make the files its rows read."""

import re
from typing import NamedTuple

from hilplant.resources import shipped_root

PAGE = shipped_root() / "docs" / "thesis.md"
#: In a table's cell; behind it `(long)` where no test runs it, `(refused)` where it is to end with exit code 1.
_COMMAND = re.compile(r"`(hilplant [^`]+)`(?: \((long|refused)\))?")


class Row(NamedTuple):
    """One item of the thesis: its commands, each with what stands behind it, what comes out, and its state."""

    number: int
    item: str
    commands: list[tuple[str, str]]
    here: str
    state: str


def _rows(text: str) -> list[Row]:
    found = []
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("| ") else []
        if len(cells) == 5 and cells[0].isdigit():
            found.append(Row(int(cells[0]), cells[1], _COMMAND.findall(cells[2]), cells[3], cells[4]))
    return found


_TEXT = PAGE.read_text(encoding="utf-8")
ROWS = _rows(_TEXT)
#: The lines of the page's blocks of commands.
PREPARED = [line for block in re.findall(r"```\n(.*?)```", _TEXT, re.DOTALL) for line in block.splitlines()]
