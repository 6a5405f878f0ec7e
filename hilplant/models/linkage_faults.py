"""What is broken between crank and blades: a lost arm, a broken link.

Where an arm is lost, or its link is broken so that it stays where it is, the wiper has no longer what arm and blade of
that side put on the crank: their part of inertia M, gravity G and drag D, and the friction of the blade,

    M(angle) dw/dt + s [M'(angle) w^2/2 + G(angle) + V^2 D(angle)] less the same with the side's own M, G and D.

The rocker and the link, a few hundred grams near the pivots, stay. Of a lost arm the angle shown is that of its rocker;
an arm whose link is broken is shown where it was when the link broke, and on its rocker again once it is whole: an arm
that falls, or is blown about, is not modelled.
"""

from typing import NamedTuple

from hilplant.jit import compiled, compiled_apart
from hilplant.models import tables as channel
from hilplant.models.lookup import derivative, value
from hilplant.models.mechanical_records import LinkageCondition, LinkageState
from hilplant.models.records import Blade, Load, Parameters
from hilplant.models.resistance import Crank, Resistance
from hilplant.models.row import changed
from hilplant.signals import Inputs

#: `LinkageCondition.left` and `right`.
WHOLE, ARM_LOST, LINK_BROKEN = 0.0, 1.0, 2.0


class NoForce(NamedTuple):
    """A blade that is not pressed on the screen."""

    force_n: float


class BothBlades(NamedTuple):
    """Both blades."""

    left_blade: Blade
    right_blade: Blade


@compiled
def without_lost_blades(load: Load, condition: LinkageCondition) -> Load:
    """Return the load without the friction of blades that do not move with the crank."""
    left, right = load.left_blade, load.right_blade
    if condition.left != WHOLE:
        left = changed(left, NoForce(0.0))
    if condition.right != WHOLE:
        right = changed(right, NoForce(0.0))
    return changed(load, BothBlades(left, right))


@compiled
def without_lost_sides(whole: Resistance, crank: Crank, parameters: Parameters, inputs: Inputs) -> Resistance:
    """Return the load of the whole wiper without what arms and blades that are lost put on the crank."""
    condition = parameters.linkage
    if condition.left == WHOLE and condition.right == WHOLE:
        return whole
    return less_sides(whole, crank, condition, int(parameters.load.points), inputs.vehicle_speed_m_s)


@compiled_apart
def less_sides(whole: Resistance, crank: Crank, condition: LinkageCondition, points: int, air_m_s: float) -> Resistance:
    """Return the same where a side is lost."""
    first = channel.POINTS + 2 * points
    less = Resistance(0.0, 0.0, 0.0, 0.0)
    if condition.left != WHOLE:
        less = carried(crank, first, air_m_s)
    if condition.right != WHOLE:
        right = carried(crank, first + channel.SIDE_CHANNELS, air_m_s)
        less = Resistance(less.inertia + right.inertia, less.bias + right.bias, 0.0, 0.0)
    return Resistance(max(0.0, whole.inertia - less.inertia), whole.bias - less.bias, whole.dry, whole.slope)


@compiled
def carried(crank: Crank, first: int, air_m_s: float) -> Resistance:
    """Return what arm and blade of the side whose channels begin at `first` put on the crank, without friction."""
    tables, place, turning = crank.tables, crank.place, crank.speed_rad_s
    bias = 0.5 * turning * turning * derivative(tables, place, first) + value(tables, place, first + 1)
    bias += air_m_s * air_m_s * value(tables, place, first + 2)
    return Resistance(value(tables, place, first), bias, 0.0, 0.0)


@compiled
def broken_at(crank: Crank, condition: LinkageCondition, before: LinkageState) -> LinkageState:
    """Return where the rockers stand whose link is broken; 0 for the others."""
    left, right = 0.0, 0.0
    if condition.left == LINK_BROKEN:
        left = before.left_rad if before.left_rad != 0.0 else value(crank.tables, crank.place, channel.LEFT_ROCKER)
    if condition.right == LINK_BROKEN:
        right = before.right_rad if before.right_rad != 0.0 else value(crank.tables, crank.place, channel.RIGHT_ROCKER)
    return LinkageState(left, right)
