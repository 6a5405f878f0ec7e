"""How far something long has come: what a room reports; the command line shows it, a page may stop it."""

from collections.abc import Callable
from typing import NamedTuple


class ProgressReport(NamedTuple):
    """What is going on, how much of it is done, of how much, and what there is to say about it."""

    stage: str
    done: float
    total: float
    note: str = ""


#: Hears of each report; it may raise :class:`Stopped`, which ends what is going on.
OnProgress = Callable[[ProgressReport], None]


class Stopped(KeyboardInterrupt):
    """Raised by a callback to end what is going on, as Ctrl-C does.

    A training ends with the best so far; an identification leaves its journal, from which `resume` goes on.
    """


def unseen(_: ProgressReport) -> None:
    """Show nothing."""
