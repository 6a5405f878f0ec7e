"""How far something long has come: what a room reports; the command line shows it."""

from collections.abc import Callable
from typing import NamedTuple


class ProgressReport(NamedTuple):
    """What is going on, how much of it is done, of how much, and what there is to say about it."""

    stage: str
    done: float
    total: float
    note: str = ""


OnProgress = Callable[[ProgressReport], None]


def unseen(_: ProgressReport) -> None:
    """Show nothing."""
