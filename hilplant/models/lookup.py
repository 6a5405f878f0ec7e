"""Linkage angles over the crank angle from a table, the look-up-table kinematics of section 6.2 of Dooner (2016)."""

from typing import Any

from hilplant.jit import compiled
from hilplant.units import TURN_RAD


@compiled
def hermite(tables: Any, channel: int, crank_angle_rad: float) -> tuple[float, float]:
    """Return the angle [rad] and its derivative over the crank angle [rad/rad] by cubic Hermite interpolation.

    Parameters
    ----------
    tables
        Array [channels, n + 1, 2]: angle and derivative at n + 1 even steps from 0 to one turn, both included.
    channel
        Which of the tables; passed as a number because cutting it out of the array costs more than reading it.
    crank_angle_rad
        In [0, 2 pi). Anything else, not-a-number included, reads the first knot.

    The error falls with the fourth power of the step in the angle, with the third in the derivative.

    """
    intervals = tables.shape[1] - 1
    place = crank_angle_rad * (intervals / TURN_RAD)
    if not 0.0 <= place < intervals:
        place = 0.0
    index = int(place)
    u = place - index
    width = TURN_RAD / intervals
    y0, y1 = tables[channel, index, 0], tables[channel, index + 1, 0]
    m0, m1 = tables[channel, index, 1] * width, tables[channel, index + 1, 1] * width
    rise = y1 - y0
    c2 = 3.0 * rise - 2.0 * m0 - m1
    c3 = m0 + m1 - 2.0 * rise
    angle = y0 + u * (m0 + u * (c2 + u * c3))
    slope = (m0 + u * (2.0 * c2 + u * (3.0 * c3))) / width
    return angle, slope
