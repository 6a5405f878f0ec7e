"""One answer of the examination."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

State = Literal["ok", "warn", "bad"]


@dataclass(frozen=True, slots=True)
class MachineFinding:
    """What was examined, how it stands, what that means, and the command that fixes it ("" when none is needed)."""

    name: str
    state: State
    what: str
    mend_command: str = ""


def first_line(path: Path) -> str:
    """Return the first line of a file, "" when it cannot be read."""
    try:
        return path.read_text(encoding="utf-8", errors="replace").split("\n")[0].strip()
    except OSError:
        return ""
