"""What every model of the load is given, and what it answers."""

from typing import Any, NamedTuple

from hilplant.models.lookup import Interval


class Crank(NamedTuple):
    """Where the crank is, in [0, 2 pi) and in the tables, and how fast it turns."""

    tables: Any
    place: Interval
    angle_rad: float
    speed_rad_s: float


class Resistance(NamedTuple):
    """The load at one angle, near one speed of the crank.

    In the direction of motion s it opposes a crank of speed u = |w| with inertia x acceleration + s bias + dry +
    slope u. `dry` and `slope` are friction and brake; they are not negative, so that they take energy at any speed.
    """

    inertia: float  # [kg m2]
    bias: float  # [N m], positive when it opposes positive speed
    dry: float  # [N m]
    slope: float  # [N m s/rad]
