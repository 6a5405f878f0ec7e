"""A run as the page sees it: the ring's rows, for each browser what it has chosen, at its own pace."""

import time
from collections.abc import Sequence

import numpy as np

from hilplant.arrays import Floats
from hilplant.channel.run_files import column_of
from hilplant.operator_page.blocks import NEWEST, STRETCH, block
from hilplant.operator_page.envelope import Envelope, of_points
from hilplant.runtime.follower import Follower
from hilplant.units import SECOND_NS

_TICK, _DEADLINE = 0, 1
MOST_SIGNALS, MOST_POINTS = 32, 20_000
#: How often the offset between the loop's clock and the wall's is forgotten [s].
_FORGET_S = 60.0


class Selection:
    """What one browser wants to see: signals of the charts, thinned by `every` ticks."""

    def __init__(self, names: Sequence[str], every: int, number: int) -> None:
        """Look the signals up.

        Raises
        ------
        ValueError
            When one is not known, or too many are asked for.
        """
        if len(names) > MOST_SIGNALS:
            raise ValueError(f"at most {MOST_SIGNALS} signals, not {len(names)}")
        self.places = [column_of(name) for name in names]
        self.number = number
        self._envelope = Envelope(every)

    def points(self, rows: Floats) -> tuple[Floats, Floats]:
        """Return times [s] and values of the rows [n, width] that have come."""
        return self._envelope.add(rows[:, _TICK], rows[:, _DEADLINE] / SECOND_NS, rows[:, self.places])


class LiveRows:
    """One browser's own reader of the ring."""

    def __init__(self, ring: str) -> None:
        """Open the ring."""
        self._follower = Follower(ring)
        self._ring = ring
        self._offset_s, self._since_s = np.inf, 0.0

    def newest(self, selection: Selection) -> bytes:
        """Return what has come since the last call."""
        taken = self._follower.rows()
        rows: Floats = taken.records
        row = rows[-1] if len(rows) else self._follower.latest()
        wall_ms = self._wall_s(row[_DEADLINE] / SECOND_NS) * 1e3
        return block(NEWEST, selection.number, selection.points(rows), row, wall_ms=wall_ms, lost=taken.lost)

    def skip(self) -> None:
        """Leave out what has come meanwhile."""
        self._follower.rows()

    def stretch(self, names: Sequence[str], span_s: tuple[float, float], points: int, number: int) -> bytes:
        """Return a stretch of the last minute, as finely as `points` allow."""
        places = Selection(names, 1, 0).places
        history = Follower(self._ring, history=True)
        rows: Floats = history.rows().records
        history.close()
        times_s = rows[:, _DEADLINE] / SECOND_NS
        first, last = np.searchsorted(times_s, span_s)
        part = rows[first:last]
        found = of_points(part[:, _TICK], times_s[first:last], part[:, places], min(points, MOST_POINTS))
        return block(STRETCH, number, found)

    def _wall_s(self, deadline_s: float) -> float:
        """Return when a row was made, as the least that lay between its deadline and its being seen tells it."""
        now_s = time.time()
        if now_s - self._since_s > _FORGET_S:
            self._offset_s, self._since_s = np.inf, now_s
        if deadline_s > 0.0:  # before that the loop has not begun
            self._offset_s = min(self._offset_s, now_s - deadline_s)
        return min(self._offset_s + deadline_s, now_s)

    @property
    def ended(self) -> bool:
        """Whether the loop has written its last row."""
        return self._follower.ended

    def close(self) -> None:
        """Let go of the ring."""
        self._follower.close()
