"""What stands in the wiper's way: snow and stops at the ends of an arm's sweep, a jam at a crank angle, ice.

Beyond an arm angle p0 something presses with k (p - p0) against the arm's way outwards, and with the part `rebound` of
it on the way back: 0 is snow, which stays where it was pushed, 1 a spring or a stop. Per turn in and out the wiper
loses (1 - rebound) k d^2/2, with d the farthest p - p0. With the rate J = dp/da of the arm by the crank angle this is
at the crank, in the direction of motion,

    outwards  k (p - p0) |J|,    back  -rebound k (p - p0) |J|,

the sum of a torque that belongs to the angle and one that always opposes motion. Ice holds a blade with a constant
torque at the arm until the arm has turned by `slip_rad` in all; then it is free until the ice is taken away and
comes again. A jam resists with a constant torque wherever the crank is within its angle, in both directions.
"""

from typing import NamedTuple

from hilplant.jit import compiled, compiled_apart
from hilplant.models import tables as channel
from hilplant.models.lookup import derivative, value
from hilplant.models.mechanical_records import IceState, Obstacles, SideObstacles
from hilplant.models.records import Parameters
from hilplant.models.resistance import Crank, Resistance
from hilplant.models.row import changed
from hilplant.units import TURN_RAD


class Met(NamedTuple):
    """What one arm meets, at the crank [N m]: `bias` opposes positive speed, `dry` opposes any."""

    bias: float
    dry: float


class Frozen(NamedTuple):
    """With what the ice still holds a blade."""

    frozen_n_m: float


class BothSides(NamedTuple):
    """What both arms meet."""

    left: SideObstacles
    right: SideObstacles


@compiled
def obstructed(free: Resistance, crank: Crank, parameters: Parameters) -> Resistance:
    """Return the load with what is in its way at this angle."""
    return hindered(free, crank, parameters.obstacles, parameters.left_arm.offset_rad, parameters.right_arm.offset_rad)


@compiled_apart
def hindered(free: Resistance, crank: Crank, of: Obstacles, left_rad: float, right_rad: float) -> Resistance:
    """Return the same, with the angles from the rockers to the arms."""
    left = met(crank, channel.LEFT_ROCKER, left_rad, of.left)
    right = met(crank, channel.RIGHT_ROCKER, right_rad, of.right)
    dry = free.dry + left.dry + right.dry
    away = abs(crank.angle_rad - of.jam_rad)
    if min(away, abs(TURN_RAD - away)) <= of.jam_half_rad:
        dry += of.jam_n_m
    return Resistance(free.inertia, free.bias + left.bias + right.bias, dry, free.slope)


@compiled
def met(crank: Crank, rocker: int, offset_rad: float, side: SideObstacles) -> Met:
    """Return what one arm meets."""
    arm, rate = value(crank.tables, crank.place, rocker) + offset_rad, derivative(crank.tables, crank.place, rocker)
    against = side.high_n_m_rad * max(0.0, arm - side.high_rad) - side.low_n_m_rad * max(0.0, side.low_rad - arm)
    torque = against * rate
    dry = 0.5 * (1.0 - side.rebound) * abs(torque) + side.frozen_n_m * abs(rate)
    return Met(0.5 * (1.0 + side.rebound) * torque, dry)


@compiled
def with_ice_left(of: Obstacles, ice: IceState) -> Obstacles:
    """Return the obstacles without the ice that a blade has left."""
    left, right = of.left, of.right
    if ice.left_rad >= of.slip_rad:
        left = changed(left, Frozen(0.0))
    if ice.right_rad >= of.slip_rad:
        right = changed(right, Frozen(0.0))
    return changed(of, BothSides(left, right))


@compiled
def ice_after(ice: IceState, of: Obstacles, before: Crank, after: Crank) -> IceState:
    """Return how far the arms have turned against the ice a tick later; without ice it begins anew.

    `of` is what the parameters say, with ice that has already been left.
    """
    if of.left.frozen_n_m == 0.0 and of.right.frozen_n_m == 0.0:
        return IceState(0.0, 0.0)
    left, right = 0.0, 0.0
    if of.left.frozen_n_m != 0.0:
        left = ice.left_rad + turned(before, after, channel.LEFT_ROCKER)
    if of.right.frozen_n_m != 0.0:
        right = ice.right_rad + turned(before, after, channel.RIGHT_ROCKER)
    return IceState(left, right)


@compiled
def turned(before: Crank, after: Crank, rocker: int) -> float:
    """Return how far a rocker turns between two angles of the crank [rad]."""
    return abs(value(after.tables, after.place, rocker) - value(before.tables, before.place, rocker))
