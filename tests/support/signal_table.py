"""The table of the plant's signals in docs/can.md, written from their declaration.

Renew it with ``python tests/support/signal_table.py``.
"""

import re
from pathlib import Path

from hilplant.declaration import Signal
from hilplant.signals import INPUTS, OUTPUTS, STATUS

PAGE = Path(__file__).parents[2] / "docs" / "can.md"
COMMAND = "python tests/support/signal_table.py"
_ROW = re.compile(r"(?:^\| (?:in|out|status) \|.*\n)+", re.MULTILINE)


def table() -> str:
    """Return the rows of the table."""
    kinds = (("in", INPUTS), ("out", OUTPUTS), ("status", STATUS))
    return "".join(f"{_row(way, signal)}\n" for way, listed in kinds for signal in listed)


def written() -> str:
    """Return the rows that the page has."""
    found = _ROW.findall(PAGE.read_text(encoding="utf-8"))
    assert len(found) == 1, f"{PAGE.name} has {len(found)} tables of signals"
    return found[0]


def renew() -> None:
    """Write the table into the page."""
    PAGE.write_text(PAGE.read_text(encoding="utf-8").replace(written(), table()), encoding="utf-8")


def _row(way: str, signal: Signal) -> str:
    span = {
        "flag": "0, 1",
        "choice": ", ".join(signal.choices),
        "count": "count",
        "real": f"{signal.minimum:.4g} to {signal.maximum:.4g}",
    }[signal.kind]
    return f"| {way} | `{signal.name}` | {signal.unit} | {span} | {signal.meaning} |"


if __name__ == "__main__":
    renew()
