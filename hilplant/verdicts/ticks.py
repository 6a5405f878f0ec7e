"""Judges an expectation tick by tick while the run goes on: the same verdicts as `arrays`, known as early as can be.

What grows with a run is one entry for each stretch, trigger or lost tick; values are kept only for as long as a level
has to hold.
"""

import math
from collections import deque
from collections.abc import Mapping
from typing import Protocol

from hilplant.verdicts.expectations import (
    Comes,
    Condition,
    Count,
    Edge,
    Expectation,
    Holds,
    Level,
    Response,
    Settles,
    Stays,
    Steps,
    Window,
    is_over,
)
from hilplant.verdicts.judgement import NO_WINDOW, Judgement, Piece, combine, unless_hidden

Row = Mapping[str, float]


class _Stretch(Protocol):
    """One stretch of a window, being judged; `broken` is the tick that violated it although it goes on."""

    @property
    def broken(self) -> int | None:
        """The tick."""

    def take(self, tick: int, value: float) -> Piece | None:
        """Take the next value; the piece where no later value can change it."""

    def close(self, cut: bool) -> Piece:
        """Judge what there was."""


class LiveExpectation:
    """One expectation on a run that goes on; not for rules about frames, which are judged from the run's frames."""

    def __init__(self, expectation: Expectation) -> None:
        self._rule, self._window = expectation.rule, expectation.window
        self._condition = expectation.condition
        self._before: Row | None = None
        self._start, self._end = _Steps(self._window.after), _Steps(self._window.until)
        self._tick = -1
        self._first: int | None = None
        self._lost_ticks: list[int] = []
        self._open: list[tuple[int, _Stretch]] = []
        self._done: dict[int, Piece] = {}
        self._begun: list[int] = []
        self._searches = expectation.searches
        self._met = self._over = self._hidden = False

    def take(self, row: Row, seen: bool = True) -> None:
        """Take the next tick; of a tick that was lost, the values of the one before."""
        self._tick += 1
        if not seen:
            self._lost_ticks.append(self._tick)
        if self._first is None and self._start.reached(self._tick, row, self._before):
            self._first = self._tick
            self._end.begin(self._tick)
            self._over = is_over(self._window.until, self._tick)
        window = self._first is not None and not self._closed(row)
        self._hidden = self._hidden or (window and not seen and self._searches)
        inside = window and self._holds(self._window.during, row)
        self._advance(inside, row)
        self._before = row

    @property
    def decided(self) -> bool:
        """Whether no later tick can change the verdict."""
        if self._first is None or self._open:
            return False
        ended = self._over or (bool(self._window.until) and self._end.arrived)
        once = isinstance(self._rule, Comes | Settles | Stays) and not self._window.during
        return ended or (once and bool(self._done))

    @property
    def failed(self) -> bool:
        """Whether it is violated already, and nothing was lost before that."""
        broken = [(first, stretch.broken) for first, stretch in self._open if stretch.broken is not None]
        lost = [any(first <= gap <= tick for gap in self._lost_ticks) for first, tick in broken]
        return not all(lost) or self.judgement().ruling == "fail"

    def judgement_now(self) -> Judgement:
        """Return the verdict on what is decided so far, and on what is violated although it goes on."""
        broken = {first: stretch.close(True) for first, stretch in self._open if stretch.broken is not None}
        return self._judgement(self._done | broken)

    def end(self) -> Judgement:
        """Return the verdict: no more ticks will come."""
        for first, stretch in self._open:
            self._done[first] = stretch.close(True)
        self._open = []
        return self.judgement()

    def judgement(self) -> Judgement:
        """Return the verdict on what is decided so far."""
        return self._judgement(self._done)

    def _judgement(self, done: Mapping[int, Piece]) -> Judgement:
        if self._first is None:
            return Judgement("blocked", reason=NO_WINDOW)
        pieces = [(first, done[first]) for first in self._begun if first in done]
        gaps = [any(first <= lost <= piece.tick for lost in self._lost_ticks) for first, piece in pieces]
        return unless_hidden(combine([piece for _, piece in pieces], gaps), self._hidden)

    def _closed(self, row: Row) -> bool:
        return self._over or (bool(self._window.until) and self._end.reached(self._tick, row, self._before))

    def _holds(self, condition: Condition, row: Row) -> bool:
        return margin(condition, row, self._before) >= 0.0

    def _advance(self, inside: bool, row: Row) -> None:
        rule, own = self._rule, margin(self._condition, row, self._before)
        if isinstance(rule, Holds | Stays | Count):
            inside = inside and not any(math.isnan(row[part.signal]) for part in self._condition)
        if isinstance(rule, Response):
            met = inside and own >= 0.0
            if met and not self._met:
                self._begin(_Coming(Comes(rule.then, rule.ticks), self._tick))
            self._met = met
            self._feed(margin(rule.then, row, self._before))
        elif isinstance(rule, Count):
            self._count(rule, inside, own)
        elif inside:
            if not self._met:
                self._begin(_stretch(rule, self._tick))
            self._met = True
            self._feed(row[rule.signal] if isinstance(rule, Stays) else own)
        elif self._met:
            self._met = False
            for first, stretch in self._open:
                self._done[first] = stretch.close(False)
            self._open = []

    def _count(self, rule: Count, inside: bool, own: float) -> None:
        if not inside:
            self._met = False
            return
        if not self._begun:
            self._begin(_Counting(rule, self._tick))
        met = own >= 0.0
        self._feed(1.0 if met and not self._met else 0.0)
        self._met = met

    def _begin(self, stretch: _Stretch) -> None:
        self._begun.append(self._tick)
        self._open.append((self._tick, stretch))

    def _feed(self, value: float) -> None:
        left = []
        for first, stretch in self._open:
            piece = stretch.take(self._tick, value)
            if piece is None:
                left.append((first, stretch))
            else:
                self._done[first] = piece
        self._open = left


class LiveWindow:
    """The window of a rule that is judged afterwards: where it begins and ends, on a run that goes on."""

    def __init__(self, window: Window) -> None:
        self._window, self._start, self._end = window, _Steps(window.after), _Steps(window.until)
        self._tick = -1
        self._before: Row | None = None
        self._first: int | None = None
        self._last: int | None = None

    def take(self, row: Row) -> None:
        """Take the next tick."""
        self._tick += 1
        if self._first is None and self._start.reached(self._tick, row, self._before):
            self._first = self._tick
            self._end.begin(self._tick)
            if is_over(self._window.until, self._tick):
                self._last = self._first
        if self._first is not None and self._last is None and self._window.until:
            self._last = self._tick if self._end.reached(self._tick, row, self._before) else None
        self._before = row

    def bounds(self, ticks: int) -> tuple[int | None, int]:
        """Return first tick, None where none is, and the one behind the last, in a run of that length."""
        last = ticks if self._last is None else self._last
        return (None if self._first is None or self._first >= last else self._first), last


def margin(condition: Condition, row: Row, before: Row | None) -> float:
    """Return how far inside its limits a condition is at a tick; -inf where a signal has no value yet."""
    lowest = math.inf
    for part in condition:
        value = row[part.signal]
        if isinstance(part, Level):
            own = min(value - part.lowest, part.highest - value) if not math.isnan(value) else -math.inf
        else:
            own = 0.5 if _crossed(part, value, math.nan if before is None else before[part.signal]) else -0.5
            own = -math.inf if math.isnan(value) else own
        lowest = min(lowest, own)
    return lowest


def _crossed(edge: Edge, value: float, before: float) -> bool:
    known = not (math.isnan(before) or math.isnan(value))
    return known and (value > edge.level) is edge.rising and (before > edge.level) is not edge.rising


class _Steps:
    """Where a run stands on its way to an instant."""

    def __init__(self, steps: Steps) -> None:
        self._steps, self._done, self._tick = steps, 0, 0

    @property
    def arrived(self) -> bool:
        """Whether the instant has come."""
        return self._done == len(self._steps)

    def begin(self, tick: int) -> None:
        """Count from `tick` on; a condition is looked for behind it."""
        self._tick = tick + 1

    def reached(self, tick: int, row: Row, before: Row | None) -> bool:
        """Whether the instant is this tick, or was before."""
        while self._done < len(self._steps):
            step = self._steps[self._done]
            if isinstance(step, int):
                due = max(step, self._tick) if self._done == 0 else self._tick + step
                if tick < due:
                    return False
                self._tick = due
            elif tick < self._tick or margin(step, row, before) < 0.0:
                return False
            else:
                self._tick = tick
            self._done += 1
        return tick >= self._tick


def _stretch(rule: object, first: int) -> _Stretch:
    if isinstance(rule, Holds):
        return _Holding(rule, first)
    if isinstance(rule, Comes):
        return _Coming(rule, first)
    if isinstance(rule, Settles):
        return _Settling(rule, first)
    if isinstance(rule, Stays):
        return _Staying(rule, first)
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
