"""The table over the crank angle that the step reads: the whole wiper at even steps of one turn.

What the channels mean is said in :mod:`hilplant.models.tables`. Every derivative is exact, from the accelerations of
the bodies and not from differences.
"""

import numpy as np

from hilplant.arrays import Floats
from hilplant.mechanics.motion import motion
from hilplant.mechanics.reduction import Curve, Reduction, reduce
from hilplant.mechanics.wiper import Wiper
from hilplant.models.tables import (
    DAMPING,
    DRAG,
    GRAVITY,
    INERTIA,
    LEFT_LIFT,
    LEFT_ROCKER,
    POINTS,
    RIGHT_LIFT,
    RIGHT_ROCKER,
    channels,
)
from hilplant.units import TURN_RAD

#: Even steps of a turn; docs/dynamics.md says what more or fewer would give.
KNOTS = 1024


def run_time_table(wiper: Wiper, knots: int = KNOTS) -> Floats:
    """Tabulate the wiper over one turn of the crank.

    Returns
    -------
    ndarray of shape [knots + 1, channels, 2]
        Value and derivative by the crank angle; C-contiguous; the last knot equals the first. That the wiper comes
        back after a turn has been checked when it was assembled.

    Raises
    ------
    SolutionError
        When a position is not found.
    CoefficientError
        When a table of drag or lift does not reach over the arm's sweep.

    """
    once = exact_rows(wiper, np.linspace(0.0, TURN_RAD, knots, endpoint=False))
    return np.ascontiguousarray(np.concatenate([once, once[:1]]))


def exact_rows(wiper: Wiper, crank_rad: Floats) -> Floats:
    """Return all channels at any crank angles, [m, channels, 2], each position solved for itself."""
    reduced = reduce(wiper, motion(wiper, crank_rad))
    curves = _in_order(reduced)
    return np.stack([np.stack([curve.value, curve.slope], axis=-1) for curve in curves], axis=1)


def channel_names(points: int) -> list[str]:
    """Return a readable name with its unit for each channel of a table."""
    named = {
        LEFT_ROCKER: "left rocker [rad]",
        RIGHT_ROCKER: "right rocker [rad]",
        INERTIA: "inertia [kg m2]",
        GRAVITY: "gravity torque [N m]",
        DRAG: "drag torque [N m s2/m2]",
        LEFT_LIFT: "left lift [N s2/m2]",
        RIGHT_LIFT: "right lift [N s2/m2]",
        DAMPING: "damping of the pivots [N m s/rad]",
    }
    sides = [f"{side} blade point {index + 1} [m/rad]" for side in ("left", "right") for index in range(points)]
    carried = ("inertia [kg m2]", "gravity torque [N m]", "drag torque [N m s2/m2]")
    shares = [f"{side} arm and blade: {what}" for side in ("left", "right") for what in carried]
    return [named[channel] for channel in range(POINTS)] + sides + shares


def _in_order(reduced: Reduction) -> list[Curve]:
    """Return the curves by their channel numbers."""
    left, right = reduced.left, reduced.right
    fixed = {
        LEFT_ROCKER: left.rocker,
        RIGHT_ROCKER: right.rocker,
        INERTIA: reduced.inertia,
        GRAVITY: reduced.gravity,
        DRAG: Curve(left.drag.value + right.drag.value, left.drag.slope + right.drag.slope),
        LEFT_LIFT: left.lift,
        RIGHT_LIFT: right.lift,
        DAMPING: reduced.damping,
    }
    shares = [curve for side in (left, right) for curve in (side.inertia, side.gravity, side.drag)]
    curves = [fixed[channel] for channel in range(POINTS)] + [*left.points, *right.points, *shares]
    if len(curves) != channels(len(left.points)):
        raise ValueError(f"{len(curves)} curves are not the {channels(len(left.points))} channels of a table")
    return curves
