"""The driver's hand: a stalk moved by a written sequence, or by lines typed in a terminal."""

import math
import os
import re
import select
from collections.abc import Callable
from typing import NamedTuple

from hilplant.ecu.vocabulary import INTERVALS, Master, Stalk
from hilplant.failure import Failure

#: Gives the stalk at a time [s] since the start.
StalkSource = Callable[[float], Stalk]

#: How long [s] a button is pressed: long enough to be seen in messages of 100 ms.
PRESSES_S = {"flick": 0.3, "wash": 1.0}
#: A time this close to a movement may be before or after it, by how it was rounded.
_ROUNDING_S = 1e-6
AUTOMATIC = "automatic"
WORDS = (*(position.name.lower() for position in Master), *PRESSES_S, AUTOMATIC)
_WRITTEN = re.compile(r"([a-z]*)([0-9]*)")


class StalkError(Failure):
    """A stalk sequence that cannot be read; its text is one line for the user."""


class Move(NamedTuple):
    """One movement of the hand: to a position, to a pause, or a press of a button; None leaves as it is."""

    master: Master | None = None
    interval: int | None = None
    press: str | None = None
    automatic: bool = False

    @property
    def words(self) -> str:
        """The movement as `move_named` reads it."""
        master = self.master.name.lower() if self.master is not None else ""
        return self.press or (AUTOMATIC if self.automatic else f"{master}{self.interval or ''}")


class StalkTurn(NamedTuple):
    """A movement at a time [s]."""

    time_s: float
    move: Move


def parse_stalk(text: str) -> tuple[StalkTurn, ...]:
    """Read a sequence such as ``0:off,1:slow,6:intermittent3,20:off,22:flick``: times [s] must rise."""
    turns: list[StalkTurn] = []
    for number, entry in enumerate(text.split(","), start=1):
        place = f"stalk sequence, entry {number} '{entry.strip()}'"
        turn = _parse_entry(place, entry)
        if turns and turn.time_s <= turns[-1].time_s:
            raise StalkError(f"{place}: time must be later than {turns[-1].time_s:g} s")
        turns.append(turn)
    return tuple(turns)


def _parse_entry(place: str, entry: str) -> StalkTurn:
    time, colon, position = entry.partition(":")
    try:
        time_s = float(time)
    except ValueError:
        time_s = math.nan
    if not colon or not 0.0 <= time_s < math.inf:
        raise StalkError(f"{place}: write SECONDS:POSITION, e.g. 1.5:slow")
    move = move_named(position)
    if move is None:
        raise StalkError(f"{place}: position must be {wanted()}")
    return StalkTurn(time_s, move)


def wanted() -> str:
    """Say what may be written."""
    return f"one of {', '.join(WORDS)}, intermittent with a pause from 1 to {INTERVALS[-1]}, or the pause alone"


def move_named(text: str) -> Move | None:
    """Find a movement by its name or the beginning of it, such as ``fast``, ``i3``, ``4`` or ``wash``."""
    found = _WRITTEN.fullmatch(text.strip().lower())
    if found is None or not found[0]:
        return None
    word = next((word for word in WORDS if found[1] and word.startswith(found[1])), None)
    interval = int(found[2]) if found[2] else None
    if (found[1] and word is None) or interval not in (None, *INTERVALS):
        return None
    if interval is not None and word not in (None, "intermittent"):
        return None
    if word in PRESSES_S:
        return Move(press=word)
    if word == AUTOMATIC:
        return Move(automatic=True)
    return Move(Master[word.upper()] if word else None, interval)


def stalk_at(turns: tuple[StalkTurn, ...], elapsed_s: float) -> Stalk:
    """Return the stalk at a time [s] since the start: off and pause 1 before the first movement."""
    stalk = Stalk()
    for turn in turns:
        if turn.time_s > elapsed_s:
            break
        stalk = moved(stalk, turn.move, elapsed_s - turn.time_s)
    return stalk


class PlayedStalk:
    """The stalk as a file says, asked at times that do not run backwards; worked out anew only when it may move."""

    def __init__(self, turns: tuple[StalkTurn, ...]) -> None:
        self._turns = turns
        starts = {turn.time_s for turn in turns}
        ends = {turn.time_s + PRESSES_S[turn.move.press] for turn in turns if turn.move.press is not None}
        self._moves_s = sorted(starts | ends, reverse=True)
        self._stalk: Stalk | None = None

    def __call__(self, elapsed_s: float) -> Stalk:
        """Return the stalk at a time [s] since the start."""
        moves_s = self._moves_s
        near = bool(moves_s) and elapsed_s > moves_s[-1] - _ROUNDING_S
        if near or self._stalk is None:
            self._stalk = stalk_at(self._turns, elapsed_s)
            while moves_s and elapsed_s > moves_s[-1] + _ROUNDING_S:
                moves_s.pop()
        return self._stalk


def moved(stalk: Stalk, move: Move, ago_s: float = 0.0) -> Stalk:
    """Return the stalk some time [s] after a movement."""
    if move.press is not None:
        pressed = ago_s < PRESSES_S[move.press]
        flick, wash = pressed and move.press == "flick", pressed and move.press == "wash"
        return stalk._replace(flick=stalk.flick or flick, wash=stalk.wash or wash)
    if move.automatic:
        return stalk._replace(master=Master.INTERMITTENT, automatic=True)
    if move.master is not None:
        stalk = stalk._replace(master=move.master, automatic=False)
    return stalk._replace(interval=move.interval or stalk.interval)


class TypedStalk:
    """The stalk as typed line by line in a terminal (a first letter is enough); off until then."""

    def __init__(self, descriptor: int, answer: Callable[[str], None]) -> None:
        """Listen to an open file; `answer` is told what was understood."""
        self._descriptor = descriptor
        self._answer = answer
        self._stalk = Stalk()
        self._presses: dict[str, float] = {}
        self._open, self._begun = True, ""

    def __call__(self, elapsed_s: float) -> Stalk:
        """Read a line if one is there, without waiting."""
        if self._open and select.select([self._descriptor], [], [], 0.0)[0]:
            typed = os.read(self._descriptor, 4096)
            self._open = bool(typed)  # end of file: the position stays
            *lines, self._begun = (self._begun + typed.decode(errors="replace")).split("\n")
            if self._begun and not self._open:
                lines.append(self._begun)
            for line in lines:
                self._take(line, elapsed_s)
        pressed = {word for word, at_s in self._presses.items() if elapsed_s - at_s < PRESSES_S[word]}
        return self._stalk._replace(flick="flick" in pressed, wash="wash" in pressed)

    def _take(self, line: str, elapsed_s: float) -> None:
        move = move_named(line)
        if move is None:
            self._answer(f"stalk: type {wanted()}; a first letter will do, fl for flick")
            return
        if move.press is not None:
            self._presses[move.press] = elapsed_s
        self._stalk = moved(self._stalk, move._replace(press=None))
        self._answer(f"stalk: {move.press or stalk_words(self._stalk)}")


def stalk_words(stalk: Stalk) -> str:
    """Say in a few words where the stalk is."""
    words = AUTOMATIC if stalk.automatic else stalk.master.name.lower()
    words += f" {stalk.interval}" if stalk.master is Master.INTERMITTENT and not stalk.automatic else ""
    return words + (" + flick" if stalk.flick else "") + (" + wash" if stalk.wash else "")
