"""Rows on their way to the page: float64, little endian, a head of eight numbers first.

Head: kind, number (of the selection or the request), wall time of the newest row [ms], points, signals, lost rows,
width of the whole row, 0. Then the whole newest row, the points' times [s], and each signal's values.
"""

import numpy as np

from hilplant.arrays import Floats

NEWEST, STRETCH = 1.0, 2.0
HEAD = 8
NOTHING: Floats = np.empty(0)


def block(kind: float, number: int, points: tuple[Floats, Floats], row: Floats = NOTHING, **head: float) -> bytes:
    """Return the bytes of one message; `points` are times [n] and values [n, signals]."""
    times_s, values = points
    numbers = [
        kind, number, head.get("wall_ms", 0.0), len(times_s), values.shape[1], head.get("lost", 0.0), len(row), 0.0,
    ]  # fmt: skip
    return np.concatenate([numbers, row, times_s, values.T.reshape(-1)]).astype("<f8").tobytes()
