"""Rows for a chart: as they are, or two for so many ticks, which keep every signal's least and greatest value."""

import numpy as np

from hilplant.arrays import Floats


class Envelope:
    """Thins rows that come piece by piece. Ticks `n every` to `n every + every - 1` become two rows."""

    def __init__(self, every: int) -> None:
        """Thin by `every`; 1 and 2 leave the rows as they are."""
        self._every = every
        self._left: Floats | None = None

    def add(self, ticks: Floats, times_s: Floats, values: Floats) -> tuple[Floats, Floats]:
        """Return times [n] and values [n, signals] of what is complete; the rest waits for the next call."""
        if self._every <= 2:
            return times_s, values
        rows = np.column_stack([ticks, times_s, values])
        if self._left is not None:
            rows = np.vstack([self._left, rows])
        groups = rows[:, 0] // self._every
        whole = int(np.searchsorted(groups, groups[-1])) if len(rows) else 0
        self._left = rows[whole:]
        return thinned(rows[:whole, 1], rows[:whole, 2:], groups[:whole])


def thinned(times_s: Floats, values: Floats, groups: Floats) -> tuple[Floats, Floats]:
    """Return two rows for each group of equal, rising numbers: least and greatest value, in the order they came in.

    They stand at the group's first time and in its middle; a signal that is not finite is shown as a gap.
    """
    if not len(times_s):
        return times_s, values
    first = np.flatnonzero(np.r_[True, np.diff(groups) != 0])
    last = np.r_[first[1:], len(groups)] - 1
    least, greatest = np.minimum.reduceat(values, first), np.maximum.reduceat(values, first)
    falls = values[first] > values[last]
    shown = np.empty((2 * len(first), values.shape[1]))
    shown[::2], shown[1::2] = np.where(falls, greatest, least), np.where(falls, least, greatest)
    times = np.empty(2 * len(first))
    times[::2], times[1::2] = times_s[first], 0.5 * (times_s[first] + times_s[last])
    return times, shown


def of_points(ticks: Floats, times_s: Floats, values: Floats, points: int) -> tuple[Floats, Floats]:
    """Thin a stretch to about so many points."""
    every = int(2 * len(ticks) // max(points, 2))
    if every <= 2:
        return times_s, values
    return thinned(times_s, values, np.floor(np.arange(len(ticks)) / every))
