"""The whole wiper reduced to the crank: inertia, and torque as a straight line over the speed.

The whole wiper has one degree of freedom: linkage, arms and blades follow the crank.
With the crank's speed w, in the direction of motion s = +1 or -1, the torque at the crank is

    M(angle) dw/dt + s [M'(angle) w^2/2 + G(angle) + V^2 drag(angle)] + B(angle) |w|
        + sum of |J| F/n mu(|J w|) + brake,

B the damping of the pivots, the sum over the n points of each blade, J a point's way by crank angle, F the force of its
blade on the screen.
"""

from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models import tables as channel
from hilplant.models.friction import coefficient
from hilplant.models.lookup import derivative, value
from hilplant.models.records import Blade, Load
from hilplant.models.resistance import Crank, Resistance
from hilplant.signals import Inputs

#: Speed of the crank [rad/s] below which friction is as at this speed: the steep ends of the curves stand for
#: static friction, which the step treats as what it is.
SLOWEST_RAD_S = 0.005

MM_PER_M = 1000.0


class Pressing(NamedTuple):
    """One blade on its screen."""

    force_n: float
    wetness: float
    wear: float


@compiled
def reduced(crank: Crank, load: Load, inputs: Inputs) -> Resistance:
    """Return the reduced load, exact at the speed given, with friction as its tangent there.

    Where friction falls with speed, or the tangent would drive the shaft at some speed, it is held as what it is at
    the speed given.
    """
    tables, place, turning = crank.tables, crank.place, abs(crank.speed_rad_s)
    squared = turning * turning
    bias = 0.5 * squared * derivative(tables, place, channel.INERTIA) + value(tables, place, channel.GRAVITY)
    if inputs.vehicle_speed_m_s != 0.0:
        bias += inputs.vehicle_speed_m_s * inputs.vehicle_speed_m_s * value(tables, place, channel.DRAG)
    speed = max(turning, SLOWEST_RAD_S)
    left_blade, right_blade = left_pressing(crank, load, inputs), right_pressing(crank, load, inputs)
    torque, slope = rub(crank, speed, left_blade, right_blade, load)
    if slope < 0.0 or turning <= SLOWEST_RAD_S or slope * speed > torque:
        slope = 0.0
    dry = inputs.brake_torque_n_m + torque - slope * speed
    damping = value(tables, place, channel.DAMPING)
    return Resistance(value(tables, place, channel.INERTIA), bias, dry, slope + damping)


@compiled
def rub(crank: Crank, speed: float, left: Pressing, right: Pressing, load: Load) -> tuple[float, float]:
    """Return the torque of both blades' friction at the crank [N m], and its derivative by the crank's speed.

    One loop over the points of both, so that the machine code has the curves once: the processor has to read less.
    """
    torque, slope, way_mu, way_slope = 0.0, 0.0, 0.0, 0.0
    points = int(load.points)
    for point in range(2 * points):
        blade = left if point < points else right
        if blade.force_n != 0.0:
            way = abs(value(crank.tables, crank.place, channel.POINTS + point))
            mu, mu_slope = coefficient(MM_PER_M * way * speed, blade.wetness, blade.force_n, load.friction)
            way_mu += way * mu
            way_slope += way * way * mu_slope
        if point + 1 == points or point + 1 == 2 * points:
            share = blade.wear * blade.force_n / points
            torque, slope = torque + share * way_mu, slope + share * MM_PER_M * way_slope
            way_mu, way_slope = 0.0, 0.0
    return torque, slope


@compiled
def left_pressing(crank: Crank, load: Load, inputs: Inputs) -> Pressing:
    """Return force, wetness and wear of the left blade."""
    wetness = inputs.left_screen if inputs.left_screen >= 0.0 else inputs.screen
    force = pressed(crank, channel.LEFT_LIFT, load.left_blade, inputs.left_force, inputs.vehicle_speed_m_s)
    return Pressing(force, wetness, load.left_blade.wear * inputs.left_wear)


@compiled
def right_pressing(crank: Crank, load: Load, inputs: Inputs) -> Pressing:
    """Return force, wetness and wear of the right blade."""
    wetness = inputs.right_screen if inputs.right_screen >= 0.0 else inputs.screen
    force = pressed(crank, channel.RIGHT_LIFT, load.right_blade, inputs.right_force, inputs.vehicle_speed_m_s)
    return Pressing(force, wetness, load.right_blade.wear * inputs.right_wear)


@compiled
def pressed(crank: Crank, lift: int, blade: Blade, factor: float, vehicle_speed_m_s: float) -> float:
    """Return the force of a blade on the screen [N]: that of the arm less lift, (4.52), never below 0."""
    force = blade.force_n * factor
    if vehicle_speed_m_s != 0.0:
        force -= vehicle_speed_m_s * vehicle_speed_m_s * value(crank.tables, crank.place, lift)
    return max(0.0, force)
