"""Judges expectations on a whole run: arrays with one value for each tick.

The robustness is that of signal temporal logic: minimum over "every", maximum over "some", sliding where both nest.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.ndimage import minimum_filter1d

from hilplant.arrays import Flags, Floats
from hilplant.verdicts.expectations import (
    Comes,
    Condition,
    Count,
    Edge,
    Expectation,
    Frames,
    Holds,
    Level,
    Response,
    Rule,
    Settles,
    Stays,
    Steps,
    Window,
    is_over,
)
from hilplant.verdicts.frames import FrameTimes, judge_frames
from hilplant.verdicts.judgement import LOST, NO_WINDOW, Judgement, Piece, combine, unless_hidden

#: How many ticks before and behind a violation its values are kept.
AROUND = 3


@dataclass(frozen=True)
class Trace:
    """A run: `signals` by name, one value for each tick, nan before the first; `seen` false at a tick that was lost.

    At a lost tick a signal has the value of the tick before. `frames` are the times of each message's frames.
    """

    step_s: float
    signals: Mapping[str, Floats]
    seen: Flags
    frames: Mapping[str, FrameTimes]

    @property
    def ticks(self) -> int:
        """Length of the run."""
        return len(self.seen)


def judge(expectation: Expectation, trace: Trace) -> Judgement:
    """Return the verdict on a whole run."""
    first = follow(expectation.window.after, 0, trace)
    if begin_hidden(expectation.window, first, trace.seen):
        return Judgement("inconclusive", reason=LOST)
    if first is None or first >= trace.ticks:
        return Judgement("blocked", reason=NO_WINDOW)
    until = expectation.window.until
    if until and is_over(until, first):
        return Judgement("blocked", reason=NO_WINDOW)
    end = follow(until, first + 1, trace) if until else None
    last = trace.ticks if end is None else min(end, trace.ticks)
    if isinstance(expectation.rule, Frames):
        return judge_frames(expectation.rule, trace.frames, (first, last), trace.step_s, trace.seen)
    begun, pieces = _pieces(expectation, trace, first, last)
    gaps = [not trace.seen[a : piece.tick + 1].all() for a, piece in zip(begun, pieces, strict=True)]
    hidden = expectation.searches and not trace.seen[first:last].all()
    return with_values(unless_hidden(combine(pieces, gaps), hidden), expectation, trace)


def begin_hidden(window: Window, first: int | None, seen: Flags) -> bool:
    """Say whether a lost tick may have hidden where a window begins; `first` is where it was found to begin."""
    return window.is_sought and not seen[: None if first is None else first + 1].all()


def with_values(judgement: Judgement, expectation: Expectation, trace: Trace) -> Judgement:
    """Add the values around the tick that decided."""
    if judgement.tick is None:
        return judgement
    around = slice(max(judgement.tick - AROUND, 0), judgement.tick + AROUND + 1)
    values = {name: tuple(trace.signals[name][around].tolist()) for name in expectation.signals}
    return Judgement(judgement.ruling, judgement.robustness, judgement.tick, judgement.reason, values)


def margins(condition: Condition, trace: Trace) -> Floats:
    """Return at each tick how far inside its limits a condition is; -inf where a signal has no value yet."""
    lowest = np.full(trace.ticks, np.inf)
    for part in condition:
        lowest = np.minimum(lowest, _margin(part, trace.signals[part.signal]))
    return np.where(np.isnan(lowest), -np.inf, lowest)


def _margin(part: Level | Edge, values: Floats) -> Floats:
    if isinstance(part, Level):
        return np.minimum(values - part.lowest, part.highest - values)
    above, known = values > part.level, ~np.isnan(values)
    crossed = np.zeros(len(values), np.bool_)
    crossed[1:] = (above[1:] != above[:-1]) & (above[1:] == part.rising) & known[:-1] & known[1:]
    return np.where(known, np.where(crossed, 0.5, -0.5), np.nan)


def follow(steps: Steps, tick: int, trace: Trace) -> int | None:
    """Return the tick to which steps lead from `tick`; the first number counts from the run's start."""
    for index, step in enumerate(steps):
        if isinstance(step, int):
            tick = max(step, tick) if index == 0 else tick + step
            continue
        met = margins(step, trace)[tick:] >= 0.0
        if not met.any():
            return None
        tick += int(np.argmax(met))
    return tick


def _pieces(expectation: Expectation, trace: Trace, first: int, last: int) -> tuple[list[int], list[Piece]]:
    """Judge each stretch of the window; return where they begin, and the judged."""
    inside = np.zeros(trace.ticks, np.bool_)
    inside[first:last] = margins(expectation.window.during, trace)[first:last] >= 0.0
    rule = expectation.rule
    if isinstance(rule, Holds | Stays | Count):
        known = [~np.isnan(trace.signals[part.signal]) for part in expectation.condition]
        inside &= np.logical_and.reduce(known)
    if isinstance(rule, Response):
        answered = margins(rule.then, trace)
        starts = np.flatnonzero(_begins(margins(rule.trigger, trace), inside))
        comes = Comes(rule.then, rule.ticks)
        return starts.tolist(), [_comes(comes, answered[a:], a, True) for a in starts.tolist()]
    if isinstance(rule, Count):
        return _counted(rule, trace, inside)
    bounds = np.flatnonzero(np.diff(inside, prepend=False, append=False)).reshape(-1, 2).tolist()
    values = trace.signals[rule.signal] if isinstance(rule, Stays) else margins(expectation.condition, trace)
    judged = _JUDGES[type(rule)]
    return [a for a, _ in bounds], [judged(rule, values[a:b], a, b == trace.ticks) for a, b in bounds]


def _begins(margin: Floats, inside: Flags) -> Flags:
    met = (margin >= 0.0) & inside
    begins = met.copy()
    begins[1:] &= ~met[:-1]
    return begins


def _holds(rule: Holds, margin: Floats, first: int, _cut: bool) -> Piece:
    broken = margin >= 0.0 if rule.never else margin < 0.0
    robustness = -float(np.max(margin)) if rule.never else float(np.min(margin))
    if broken.any():
        return Piece(False, robustness, first + int(np.argmax(broken)))
    return Piece(True, robustness, first + len(margin) - 1)


def _comes(rule: Comes, margin: Floats, first: int, cut: bool) -> Piece:
    within = margin[: rule.ticks + 1]
    met = within >= 0.0
    if met.any():
        return Piece(True, float(np.max(within)), first + int(np.argmax(met)))
    if len(within) <= rule.ticks:
        return Piece(None, float(np.max(within)), first + len(within) - 1, cut)
    return Piece(False, float(np.max(within)), first + rule.ticks)


def _settles(rule: Settles, margin: Floats, first: int, cut: bool) -> Piece:
    count = len(margin)
    if rule.hold is None:
        if count <= rule.by:
            return Piece(None, -np.inf, first + count - 1, cut)
        return _holds(Holds(()), margin[rule.by :], first + rule.by, cut)
    starts = min(rule.by + 1, count - rule.hold)
    if starts <= 0:
        return Piece(None, -np.inf, first + count - 1, cut)
    size = rule.hold + 1
    held = minimum_filter1d(margin[: starts + rule.hold], size, origin=-(size // 2), mode="nearest")[:starts]
    met = held >= 0.0
    if met.any():
        return Piece(True, float(np.max(held)), first + int(np.argmax(met)) + rule.hold)
    if starts <= rule.by:
        return Piece(None, float(np.max(held)), first + count - 1, cut)
    return Piece(False, float(np.max(held)), first + rule.by + rule.hold)


def _stays(rule: Stays, values: Floats, first: int, cut: bool) -> Piece:
    count = len(values) if rule.ticks is None else rule.ticks + 1
    piece = _holds(Holds(()), rule.tolerance - np.abs(values[:count] - values[0]), first, cut)
    return Piece(None, piece.margin, piece.tick, cut) if piece.holds and len(values) < count else piece


def _counted(rule: Count, trace: Trace, inside: Flags) -> tuple[list[int], list[Piece]]:
    if not inside.any():
        return [], []
    places = np.flatnonzero(inside)
    begins = np.flatnonzero(_begins(margins(rule.condition, trace), inside))
    margin = float(min(len(begins) - rule.lowest, rule.highest - len(begins)))
    if len(begins) > rule.highest:
        return [int(places[0])], [Piece(False, margin, int(begins[int(rule.highest)]))]
    return [int(places[0])], [Piece(margin >= 0.0, margin, int(places[-1]))]


_JUDGES: dict[type[Rule], Callable[[Any, Floats, int, bool], Piece]] = {
    Holds: _holds,
    Comes: _comes,
    Settles: _settles,
    Stays: _stays,
}
