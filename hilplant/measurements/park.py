"""The park switch as a measurement: contact levels, bounces, and the staircase of park steps, section 5.2.

A pulse that comes a little late gives no overlap with the measured one and so the same error as no pulse at all; a
staircase gives an error that grows with the delay (Figures 5-2, 5-3).
"""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats

#: A contact is quiet for at least this long before a change counts [s].
DEBOUNCE_S = 0.003


class ParkSignal(NamedTuple):
    """A park signal as open (0) and closed (1), and how it was told apart."""

    closed: Floats
    threshold: float
    inverted: bool
    bounces: int


def contact(values: Floats, period_s: float, inverted: bool | None = None) -> ParkSignal:
    """Tell closed from open at the middle between the signal's two levels, and remove bounces.

    With `inverted` None, the contact counts as closed at the level that the signal has for the smaller part of the
    time between its first and last change: the park window is a small part of a turn.
    """
    threshold = 0.5 * float(np.min(values) + np.max(values))
    high = values > threshold
    if inverted is None:
        changes = np.flatnonzero(np.diff(high.astype(np.int8)))
        between = high[changes[0] + 1 : changes[-1] + 1] if len(changes) > 1 else high[:0]
        inverted = len(between) > 0 and float(np.mean(between)) > 0.5
    raw = (~high if inverted else high).astype(np.float64)
    closed = debounced(raw, max(1, round(DEBOUNCE_S / period_s)))
    bounces = (int(np.count_nonzero(np.diff(raw))) - int(np.count_nonzero(np.diff(closed)))) // 2
    return ParkSignal(closed, threshold, inverted, bounces)


def debounced(raw: Floats, quiet: int) -> Floats:
    """Take the first edge of each bounce: after a change nothing counts until the signal was quiet for `quiet` samples.

    The edge keeps its instant, unlike behind a filter. A pulse shorter than `quiet` samples is a disturbance and goes.
    """
    starts = np.concatenate([[0], np.flatnonzero(np.diff(raw)) + 1])
    lengths = np.diff(np.concatenate([starts, [len(raw)]]))
    out = np.empty_like(raw)
    level, pending = raw[0], -1
    for start, length in zip(starts, lengths, strict=True):
        if raw[start] != level and pending < 0:
            pending = start
        if length >= quiet:
            if pending >= 0 and raw[start] != level:
                out[pending:start] = raw[start]
                level = raw[start]
            pending = -1
        out[start : start + length] = level
    return out


def rising_edges(closed: Floats) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Return the samples at which the contact closes: one for each turn of the crank."""
    return np.flatnonzero((closed[1:] > 0.5) & (closed[:-1] <= 0.5)) + 1


def staircase(closed: Floats) -> Floats:
    """Return the number of closings up to each sample: the "park step" of 5.2."""
    steps = np.zeros(len(closed))
    steps[rising_edges(closed)] = 1.0
    return np.cumsum(steps)


def turn_speeds(closed: Floats, time_s: Floats) -> tuple[Floats, Floats]:
    """Return the middle [s] of each turn between two closings, and its mean crank speed [rad/s]."""
    instants = time_s[rising_edges(closed)]
    turns_s = np.diff(instants)
    return instants[:-1] + 0.5 * turns_s, 2.0 * np.pi / turns_s
