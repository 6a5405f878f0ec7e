"""The fuzzy system of section 7.4 of Dooner (2016), evaluated once into a table of K over the error.

A Mamdani system: seven sets of the error, four of K, seven rules, minimum for implication, maximum for aggregation,
the centroid. The thesis tells of its Figures 7-9 and 7-10 in words only; what it tells is kept:
the error is held within 3 rad/s, at -2 rad/s it is NB to 0.125 and NM to 0.3, the sets lie tightly around zero, VS is
Z-shaped and mostly apart from the others. The rest is assumed. Where B lies follows from the thesis' own
tables: with the fuzzy system the errors in state 1 are 0.72 (Hebb) and 0.73 (Error-Hebb) of what a fixed K equal to
the gain gives, so K is near 0.72 when the error is small.
"""

from functools import lru_cache

import numpy as np

from hilplant.arrays import Floats

#: Triangles of the error [rad/s]: foot, peak, foot. The positive sets mirror the negative ones.
ERROR_SETS = {
    "NB": (-4.0, -3.0, -3.0 + 1.0 / 0.875),
    "NM": (-1.0 - 1.0 / 0.7, -1.0, -0.4),
    "NS": (-1.0, -0.4, 0.0),
    "ZO": (-0.4, 0.0, 0.4),
}
#: Triangles of K; VS is a Z-shaped function from its first to its second number.
GAIN_SETS = {"VS": (0.0, 0.3), "S": (0.1, 0.3, 0.5), "M": (0.3, 0.5, 0.7), "B": (0.4, 0.72, 1.0)}
RULES = {"NB": "VS", "PB": "VS", "NM": "S", "PM": "S", "NS": "M", "PS": "M", "ZO": "B"}

GREATEST_ERROR_RAD_S = 3.0
#: Steps of K from 0 to 1 over which the centroid is taken.
GAIN_STEPS = 400


def degrees_of_membership(errors_rad_s: Floats) -> dict[str, Floats]:
    """Return how far each error [rad/s] belongs to each of the seven sets, 0 to 1."""
    errors = np.clip(errors_rad_s, -GREATEST_ERROR_RAD_S, GREATEST_ERROR_RAD_S)
    degrees = {name: _triangle(errors, corners) for name, corners in ERROR_SETS.items()}
    mirrored = {name.replace("N", "P"): _triangle(-errors, ERROR_SETS[name]) for name in ("NB", "NM", "NS")}
    return degrees | mirrored


def gain_shapes(gains: Floats) -> dict[str, Floats]:
    """Return how far each value of K belongs to each of the four sets, 0 to 1."""
    return {
        name: _z_shape(gains, *corners) if len(corners) == 2 else _triangle(gains, corners)
        for name, corners in GAIN_SETS.items()
    }


def fuzzy_gain_at(errors_rad_s: Floats) -> Floats:
    """Return K in [0, 1] for each error [rad/s], by the rules and the centroid."""
    gains = np.linspace(0.0, 1.0, GAIN_STEPS + 1)
    shapes = gain_shapes(gains)
    degrees = degrees_of_membership(errors_rad_s)
    clipped = [np.minimum(degrees[error][:, np.newaxis], shapes[gain]) for error, gain in RULES.items()]
    return _centroid(gains, np.max(clipped, axis=0))


def _triangle(x: Floats, corners: tuple[float, ...]) -> Floats:
    return np.interp(x, corners, (0.0, 1.0, 0.0))


def _z_shape(x: Floats, begin: float, end: float) -> Floats:
    """Return 1 up to `begin`, 0 from `end` on, and two parabolas that meet half-way at 0.5."""
    fallen = np.clip((x - begin) / (end - begin), 0.0, 1.0)
    return np.where(fallen < 0.5, 1.0 - 2.0 * fallen**2, 2.0 * (1.0 - fallen) ** 2)


def _centroid(x: Floats, heights: Floats) -> Floats:
    """Return the centre of the area below each row of `heights`, straight between the points `x`; exact."""
    left, right, widths = heights[:, :-1], heights[:, 1:], np.diff(x)
    moments = widths / 6.0 * (left * (2.0 * x[:-1] + x[1:]) + right * (x[:-1] + 2.0 * x[1:]))
    areas = widths / 2.0 * (left + right)
    return np.asarray(moments.sum(axis=1) / areas.sum(axis=1))


@lru_cache(maxsize=1)
def gain_table(intervals: int = 600) -> Floats:
    """Return the table [intervals + 1, 2] of error [rad/s] and K that the loop reads."""
    errors = np.linspace(-GREATEST_ERROR_RAD_S, GREATEST_ERROR_RAD_S, intervals + 1)
    table = np.ascontiguousarray(np.stack([errors, fuzzy_gain_at(errors)], axis=1))
    return table
