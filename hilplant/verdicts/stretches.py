"""One stretch of a window, judged value by value: what each rule keeps of it until it is decided."""

import math
from collections import deque
from typing import Protocol

from hilplant.verdicts.expectations import Comes, Count, Holds, Settles, Stays
from hilplant.verdicts.judgement import Piece


class StretchJudge(Protocol):
    """One stretch of a window, being judged; `broken` is the tick that violated it although it goes on."""

    @property
    def broken(self) -> int | None:
        """The tick."""

    def take(self, tick: int, value: float) -> Piece | None:
        """Take the next value; the piece where no later value can change it."""

    def close(self, cut: bool) -> Piece:
        """Judge what there was."""


def stretch_of(rule: object, first: int) -> StretchJudge:
    """Return a stretch that begins at the tick `first`, judged by a rule.

    Raises
    ------
    TypeError
        For rules about frames.

    """
    if isinstance(rule, Holds):
        return _Holding(rule, first)
    if isinstance(rule, Comes):
        return _Coming(rule, first)
    if isinstance(rule, Settles):
        return _Settling(rule, first)
    if isinstance(rule, Stays):
        return _Staying(rule, first)
    if isinstance(rule, Count):
        return _Counting(rule, first)
    raise TypeError(f"{rule!r} is judged from frames")


class _Holding:
    def __init__(self, rule: Holds, first: int) -> None:
        self._never, self._lowest, self._tick = rule.never, math.inf, first
        self.broken: int | None = None

    def take(self, tick: int, value: float) -> None:
        self._lowest, self._tick = min(self._lowest, -value if self._never else value), tick
        if self.broken is None and (value >= 0.0 if self._never else value < 0.0):
            self.broken = tick

    def close(self, _cut: bool) -> Piece:
        return Piece(self.broken is None, self._lowest, self._tick if self.broken is None else self.broken)


class _Coming:
    broken = None

    def __init__(self, rule: Comes, first: int) -> None:
        self._due, self._highest, self._tick = first + rule.ticks, -math.inf, first
        self._met: int | None = None

    def take(self, tick: int, value: float) -> Piece | None:
        self._highest, self._tick = max(self._highest, value), tick
        if self._met is None and value >= 0.0:
            self._met = tick
        if tick < self._due:
            return None
        return Piece(self._met is not None, self._highest, tick if self._met is None else self._met)

    def close(self, cut: bool) -> Piece:
        if self._met is None:
            return Piece(None, self._highest, self._tick, cut)
        return Piece(True, self._highest, self._met)


class _Settling:
    @property
    def broken(self) -> int | None:
        return self._tail.broken

    def __init__(self, rule: Settles, first: int) -> None:
        self._by, self._hold, self._tick, self._first = first + rule.by, rule.hold, first, first
        self._tail = _Holding(Holds(()), self._by)
        self._smallest: deque[tuple[int, float]] = deque()
        self._highest = -math.inf
        self._met: int | None = None

    def take(self, tick: int, value: float) -> Piece | None:
        self._tick = tick
        if self._hold is None:
            if tick >= self._by:
                self._tail.take(tick, value)
            return None
        while self._smallest and self._smallest[-1][1] >= value:
            self._smallest.pop()
        self._smallest.append((tick, value))
        begun = tick - self._hold
        while self._smallest[0][0] < begun:
            self._smallest.popleft()
        if begun >= self._first:
            held = self._smallest[0][1]
            self._highest = max(self._highest, held)
            if self._met is None and held >= 0.0:
                self._met = tick
        if begun < self._by:
            return None
        return Piece(self._met is not None, self._highest, tick if self._met is None else self._met)

    def close(self, cut: bool) -> Piece:
        if self._hold is None:
            return self._tail.close(cut) if self._tick >= self._by else Piece(None, -math.inf, self._tick, cut)
        if self._met is None:
            return Piece(None, self._highest, self._tick, cut)
        return Piece(True, self._highest, self._met)


class _Staying:
    @property
    def broken(self) -> int | None:
        return self._holding.broken

    def __init__(self, rule: Stays, first: int) -> None:
        self._tolerance, self._first_value = rule.tolerance, math.nan
        self._due = None if rule.ticks is None else first + rule.ticks
        self._holding = _Holding(Holds(()), first)

    def take(self, tick: int, value: float) -> Piece | None:
        if math.isnan(self._first_value):
            self._first_value = value
        self._holding.take(tick, self._tolerance - abs(value - self._first_value))
        return self._holding.close(True) if tick == self._due else None

    def close(self, cut: bool) -> Piece:
        piece = self._holding.close(cut)
        return Piece(None, piece.margin, piece.tick, cut) if piece.holds and self._due is not None else piece


class _Counting:
    def __init__(self, rule: Count, first: int) -> None:
        self._rule, self._count, self._tick = rule, 0, first
        self.broken: int | None = None

    def take(self, tick: int, value: float) -> None:
        self._tick = tick
        self._count += value > 0.0
        if self.broken is None and self._count > self._rule.highest:
            self.broken = tick

    def close(self, _cut: bool) -> Piece:
        margin = float(min(self._count - self._rule.lowest, self._rule.highest - self._count))
        return Piece(margin >= 0.0, margin, self._tick if self.broken is None else self.broken)
