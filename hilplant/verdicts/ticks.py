"""Judges an expectation tick by tick while the run goes on: the same verdicts as `arrays`, known as early as can be.

What grows with a run is one entry for each stretch, trigger or lost tick; values are kept only for as long as a level
has to hold.
"""

import math
from collections.abc import Mapping

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
from hilplant.verdicts.judgement import LOST, NO_WINDOW, Judgement, Piece, combine, unless_hidden
from hilplant.verdicts.stretches import StretchJudge, stretch_of

Row = Mapping[str, float]


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
        self._open: list[tuple[int, StretchJudge]] = []
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
        if self._begin_hidden:
            return False
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
        if self._begin_hidden:
            return Judgement("inconclusive", reason=LOST)
        if self._first is None:
            return Judgement("blocked", reason=NO_WINDOW)
        pieces = [(first, done[first]) for first in self._begun if first in done]
        gaps = [any(first <= lost <= piece.tick for lost in self._lost_ticks) for first, piece in pieces]
        return unless_hidden(combine([piece for _, piece in pieces], gaps), self._hidden)

    @property
    def _begin_hidden(self) -> bool:
        """Whether a lost tick may have hidden where the window begins."""
        end = self._tick if self._first is None else self._first
        return self._window.is_sought and bool(self._lost_ticks) and self._lost_ticks[0] <= end

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
                self._begin(stretch_of(Comes(rule.then, rule.ticks), self._tick))
            self._met = met
            self._feed(margin(rule.then, row, self._before))
        elif isinstance(rule, Count):
            self._count(rule, inside, own)
        elif inside:
            if not self._met:
                self._begin(stretch_of(rule, self._tick))
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
            self._begin(stretch_of(rule, self._tick))
        met = own >= 0.0
        self._feed(1.0 if met and not self._met else 0.0)
        self._met = met

    def _begin(self, stretch: StretchJudge) -> None:
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

    @property
    def first(self) -> int | None:
        """The tick at which it began; None while it has not."""
        return self._first

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
