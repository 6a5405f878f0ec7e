"""Park switch over the crank angle, section 3.6 of Dooner (2016): a cam on the worm wheel moves its contact."""

import math
from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models.records import ParkSwitch
from hilplant.units import TURN_RAD


class Contact(NamedTuple):
    """Where the cam holds the contact, what an ECU sees, and the ticks for which it will still bounce.

    While the two differ the contact is bouncing: it has left the place where the cam holds it.
    """

    closed: float
    shown: float
    bounce_left: float


@compiled
def cam_closed(crank_angle_rad: float, closed_before: float, switch: ParkSwitch) -> float:
    """Return 1 where the cam holds the contact closed.

    It closes within `half_window_rad` of the park angle and opens beyond `half_window_rad + hysteresis_rad`;
    between the two it stays as it was, in both directions of rotation. Angles in [0, 2 pi).
    """
    distance = abs(crank_angle_rad - switch.angle_rad)
    distance = min(distance, abs(TURN_RAD - distance))
    reach = switch.half_window_rad + (switch.hysteresis_rad if closed_before > 0.5 else 0.0)
    return 1.0 if distance <= reach else 0.0


@compiled
def turned_back(crank_angle_rad: float, switch: ParkSwitch) -> float:
    """Return how far [rad] the crank is before the angle at which the contact closes; negative past it.

    A turn more or less cannot be told from the angle. The answer is the one that is nearest to the way between
    there and `reverse_angle_rad`, and right on the whole window as well if window and `reverse_angle_rad` together
    are less than a turn.
    """
    before = switch.angle_rad - switch.half_window_rad - crank_angle_rad
    highest = 0.5 * (TURN_RAD + switch.reverse_angle_rad) - switch.half_window_rad
    return before - TURN_RAD * math.ceil((before - highest) / TURN_RAD)


@compiled
def contact_now(crank_angle_rad: float, closed_before: float, bounce_left: float, switch: ParkSwitch) -> Contact:
    """Return the contact in this tick, from the position and the bouncing that the tick before left.

    The tick of an edge shows the new position; in the `bounce_ticks` ticks after it the contact changes in every
    tick, then it stays. Assumed, not measured: it serves to try an ECU's debouncing, always in the same way.
    """
    closed = cam_closed(crank_angle_rad, closed_before, switch)
    if closed != closed_before:
        return Contact(closed, closed, switch.bounce_ticks)
    if bounce_left <= 0.0:
        return Contact(closed, closed, 0.0)
    away = (switch.bounce_ticks - bounce_left) % 2.0 < 1.0
    return Contact(closed, 1.0 - closed if away else closed, bounce_left - 1.0)
