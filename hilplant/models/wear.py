"""Wear that grows with the wipes: blades rub more, brushes have more resistance, the park cam loses its edges.

With n wipes, one for each turn of the crank in either direction,

    friction of both blades   mu (1 + a n)
    resistance at both brushes   R + r n
    half the window of the park switch   max(0, half - c n).

A straight line over the wipes is assumed: it is the simplest that grows; nobody has published more for a whole wiper.
"""

from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models.records import Blade, Brush, Load, Motor, ParkSwitch
from hilplant.models.row import changed
from hilplant.models.slow_records import Wear, WearState


class WornBrushes(NamedTuple):
    """Both armature paths."""

    slow: Brush
    fast: Brush


class WornBlades(NamedTuple):
    """Both blades."""

    left_blade: Blade
    right_blade: Blade


class WornCam(NamedTuple):
    """The window that the cam still has."""

    half_window_rad: float


@compiled
def worn_motor(motor: Motor, wear: Wear, now: WearState) -> Motor:
    """Return the motor with its brushes as they are."""
    more, slow, fast = wear.brushes_ohm * now.wipes, motor.slow, motor.fast
    return changed(
        motor,
        WornBrushes(
            Brush(slow.resistance_ohm + more, slow.inductance_henry, slow.constant_v_s),
            Brush(fast.resistance_ohm + more, fast.inductance_henry, fast.constant_v_s),
        ),
    )


@compiled
def worn_load(load: Load, wear: Wear, now: WearState) -> Load:
    """Return the load with its blades as they are."""
    factor, left, right = 1.0 + wear.blades * now.wipes, load.left_blade, load.right_blade
    return changed(load, WornBlades(Blade(left.force_n, left.wear * factor), Blade(right.force_n, right.wear * factor)))


@compiled
def worn_switch(switch: ParkSwitch, wear: Wear, now: WearState) -> ParkSwitch:
    """Return the park switch with its cam as it is."""
    return changed(switch, WornCam(max(0.0, switch.half_window_rad - wear.cam_rad * now.wipes)))
