"""The driver's hand: stalk positions from a written sequence, or typed in a terminal."""

import math
import os
import select
from collections.abc import Callable
from typing import NamedTuple

from hilplant.ecu.relay_controller import Stalk
from hilplant.failure import Failure

#: Gives the stalk's position at a time [s] since the start.
StalkSource = Callable[[float], Stalk]


class StalkError(Failure):
    """A stalk sequence that cannot be read; its text is one line for the user."""


class Turn(NamedTuple):
    """From this time [s] on, the stalk is in this position."""

    time_s: float
    stalk: Stalk


def parse_stalk(text: str) -> tuple[Turn, ...]:
    """Read a sequence such as ``0:off,1:slow,6:fast``: times [s] must rise; off before the first."""
    turns: list[Turn] = []
    for number, entry in enumerate(text.split(","), start=1):
        place = f"stalk sequence, entry {number} '{entry.strip()}'"
        turn = _parse_entry(place, entry)
        if turns and turn.time_s <= turns[-1].time_s:
            raise StalkError(f"{place}: time must be later than {turns[-1].time_s:g} s")
        turns.append(turn)
    return tuple(turns)


def _parse_entry(place: str, entry: str) -> Turn:
    time, colon, position = entry.partition(":")
    try:
        time_s = float(time)
    except ValueError:
        time_s = math.nan
    if not colon or not 0.0 <= time_s < math.inf:
        raise StalkError(f"{place}: write SECONDS:POSITION, e.g. 1.5:slow")
    return Turn(time_s, _named(place, position))


def _named(place: str, text: str) -> Stalk:
    stalk = stalk_named(text)
    if stalk is None:
        raise StalkError(f"{place}: position must be one of {', '.join(s.value for s in Stalk)}")
    return stalk


def stalk_named(text: str) -> Stalk | None:
    """Find a position by its name or the beginning of its name."""
    word = text.strip().lower()
    return next((stalk for stalk in Stalk if word and stalk.value.startswith(word)), None)


def stalk_at(turns: tuple[Turn, ...], elapsed_s: float) -> Stalk:
    """Return the position at a time [s] since the start."""
    position = Stalk.OFF
    for turn in turns:
        if turn.time_s > elapsed_s:
            break
        position = turn.stalk
    return position


class TypedStalk:
    """The position last typed as a line in a terminal (a first letter is enough); off until then."""

    def __init__(self, descriptor: int, answer: Callable[[str], None]) -> None:
        """Listen to an open file; `answer` is told what was understood."""
        self._descriptor = descriptor
        self._answer = answer
        self._stalk = Stalk.OFF
        self._open = True

    def __call__(self, elapsed_s: float) -> Stalk:
        """Read a line if one is there, without waiting."""
        if self._open and select.select([self._descriptor], [], [], 0.0)[0]:
            typed = os.read(self._descriptor, 4096)
            self._open = bool(typed)  # end of file: the position stays
            for line in typed.decode(errors="replace").splitlines():
                self._take(line)
        return self._stalk

    def _take(self, line: str) -> None:
        stalk = stalk_named(line)
        if stalk is None:
            self._answer(f"stalk: type {', '.join(s.value for s in Stalk)}, or a first letter")
        else:
            self._stalk = stalk
            self._answer(f"stalk: {stalk.value}")
