"""Quantities over the crank angle from a table, as the look-up-table kinematics of section 6.2 of Dooner (2016)."""

import math
from typing import Any, NamedTuple

from hilplant.jit import compiled
from hilplant.units import TURN_RAD


class Interval(NamedTuple):
    """The interval of the table in which an angle lies, and what its four numbers weigh there.

    The weights are the cubic Hermite polynomials for the values and derivatives at both ends, then the
    derivatives of these polynomials.
    """

    first: int  # of the two knots
    value_0: float
    value_1: float
    slope_0: float
    slope_1: float
    value_rate: float  # of the value at the end; at the start it is the negative of it
    slope_0_rate: float
    slope_1_rate: float


@compiled
def within_turn(angle_rad: float) -> float:
    """Return the same angle in [0, 2 pi); not-a-number stays what it is."""
    if 0.0 <= angle_rad < TURN_RAD:
        return angle_rad
    wrapped = angle_rad - TURN_RAD * math.floor(angle_rad / TURN_RAD)
    return wrapped if 0.0 <= wrapped < TURN_RAD else wrapped * 0.0


@compiled
def find(tables: Any, crank_angle_rad: float) -> Interval:
    """Return the interval of a crank angle in [0, 2 pi); anything else, not-a-number included, is the first knot."""
    intervals = tables.shape[0] - 1
    width = TURN_RAD / intervals
    place = crank_angle_rad * (intervals / TURN_RAD)
    if not 0.0 <= place < intervals:
        place = 0.0
    index = int(place)
    u = place - index
    value_1 = u * u * (3.0 - 2.0 * u)
    away = 1.0 - u
    return Interval(
        index,
        1.0 - value_1,
        value_1,
        width * u * away * away,
        -width * u * u * away,
        6.0 * u * away / width,
        away * (1.0 - 3.0 * u),
        u * (3.0 * u - 2.0),
    )


@compiled
def value(tables: Any, place: Interval, channel: int) -> float:
    """Return the value of a channel by cubic Hermite interpolation; its error falls with the step's fourth power."""
    at = place.first
    ends: float = place.value_0 * tables[at, channel, 0] + place.value_1 * tables[at + 1, channel, 0]
    slopes: float = place.slope_0 * tables[at, channel, 1] + place.slope_1 * tables[at + 1, channel, 1]
    return ends + slopes


@compiled
def derivative(tables: Any, place: Interval, channel: int) -> float:
    """Return the derivative of a channel by the crank angle; its error falls with the step's third power."""
    at = place.first
    ends: float = place.value_rate * (tables[at + 1, channel, 0] - tables[at, channel, 0])
    slopes: float = place.slope_0_rate * tables[at, channel, 1] + place.slope_1_rate * tables[at + 1, channel, 1]
    return ends + slopes
