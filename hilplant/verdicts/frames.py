"""Judges the frames of a message: their gaps, how many are missing, and whether counter and checksum are right."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from hilplant.arrays import Flags, Whole
from hilplant.verdicts.expectations import Frames
from hilplant.verdicts.judgement import LOST, NO_WINDOW, Judgement

NO_FRAME = "no frame came"


def _nothing() -> Flags:
    return np.zeros(0, np.bool_)


@dataclass(frozen=True)
class FrameTimes:
    """The frames of one message: the tick of each, in order; `cycle_ms` as the database states it, 0 where it does not.

    `counter_ok` and `crc_ok` say of each frame whether it passed; empty where nothing protects the message.
    """

    ticks: Whole
    cycle_ms: float = 0.0
    counter_ok: Flags = field(default_factory=_nothing)
    crc_ok: Flags = field(default_factory=_nothing)


def judge_frames(
    rule: Frames, frames: Mapping[str, FrameTimes], window: tuple[int, int], step_s: float, seen: Flags
) -> Judgement:
    """Return the verdict on the frames from tick `window[0]` on, before `window[1]`."""
    first, last = window
    if first >= last:
        return Judgement("blocked", reason=NO_WINDOW)
    known = frames[rule.message]
    inside = (known.ticks >= first) & (known.ticks < last)
    if rule.rule in ("counter", "crc"):
        right = (known.counter_ok if rule.rule == "counter" else known.crc_ok)[inside]
        found = _wrong(rule, right, known.ticks[inside])
    else:
        found = _gaps(rule, known, known.ticks[inside], (first, last), step_s * 1e3)
    if found.tick is not None and not seen[first : found.tick + 1].all():
        return Judgement("inconclusive", found.robustness, found.tick, LOST)
    return found


def gap_limits(rule: Frames, cycle_ms: float) -> tuple[float, float]:
    """Return the shortest and longest gap [ms] that a rule allows."""
    if rule.rule == "period":
        return rule.lowest, rule.highest
    return cycle_ms - rule.highest, cycle_ms + rule.highest


def _wrong(rule: Frames, right: Flags, ticks: Whole) -> Judgement:
    if not len(ticks):
        return Judgement("blocked", reason=NO_FRAME)
    wrong = ticks[~right]
    margin = rule.highest - len(wrong)
    if margin < 0:
        return Judgement("fail", margin, int(wrong[int(rule.highest)]))
    return Judgement("pass", margin, int(ticks[-1]))


def _gaps(rule: Frames, known: FrameTimes, ticks: Whole, window: tuple[int, int], step_ms: float) -> Judgement:
    """Judge the gaps between frames, and from the window's ends to the first and last frame."""
    first, last = window
    bounds = np.concatenate([[first], ticks, [last]])
    gaps = np.diff(bounds) * step_ms
    inner = np.zeros(len(gaps), np.bool_)
    inner[1:-1] = True
    if rule.rule == "missing":
        cycles = gaps / known.cycle_ms
        missed = np.where(inner, np.round(cycles) - 1.0, np.ceil(cycles - 1e-9) - 1.0)
        total = np.cumsum(np.maximum(missed, 0.0))
        margins, late = rule.highest - total, bounds[1:]
    else:
        shortest, longest = gap_limits(rule, known.cycle_ms)
        margins = np.where(inner, np.minimum(gaps - shortest, longest - gaps), longest - gaps)
        overdue = bounds[:-1] + math.floor(longest / step_ms + 1e-9) + 1
        late = np.where(longest - gaps < -1e-9, np.minimum(overdue, bounds[1:]), bounds[1:])
    margins = np.where(np.abs(margins) < 1e-9, 0.0, margins)
    robustness = float(np.min(margins))
    if robustness < 0.0:
        return Judgement("fail", robustness, min(int(late[int(np.argmax(margins < 0.0))]), last - 1))
    return Judgement("pass", robustness, last - 1)
