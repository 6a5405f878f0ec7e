"""Wiper blades: two rods fixed to the end of their arm, section 4.2.3, and the points where friction acts.

The blade is the bodies O-A and O-B of (4.40), from the arm's end O to each tip, both at a fixed angle to the arm.
The printed constraint vector (4.41) lets the second body begin at the end of the first; its Jacobian (4.42) lets
both begin at O. Only the second gives the blade of Figure 4-7, so that is built here.
"""

import math
from collections.abc import Mapping, Sequence

from hilplant.mechanics.design_points import plane_points, refuse_coincident
from hilplant.mechanics.planar import Body, Pin, Point

Tips = tuple[Point, Point]


def blade_tips(written: Mapping[str, Sequence[float]]) -> Tips:
    """Return both tips A and B of a blade [m], seen from the joint O that holds it, at the design position.

    Raises
    ------
    GeometryError
        For points that are missing, not numbers, or one on the other.

    """
    o, a, b = plane_points("blade", "OAB", written)
    refuse_coincident("blade", {"O": o, "A": a, "B": b}, ["OA", "OB", "AB"])
    return (a[0] - o[0], a[1] - o[1]), (b[0] - o[0], b[1] - o[1])


def blade_bodies(side: str, joint: Point, tips: Tips) -> tuple[Body, Body]:
    """Return the two rods of the blade whose joint stands at a point of the plane [m], each from O to its tip."""
    ends = [(joint[0] + tip[0], joint[1] + tip[1]) for tip in tips]
    first, second = (Body.between(f"{side}_blade_{letter}", joint, end) for letter, end in zip("ab", ends, strict=True))
    return first, second


def friction_pins(bodies: tuple[Body, Body], points: int) -> tuple[Pin, ...]:
    """Return where friction acts on the blade, as places on its bodies.

    One point is the blade's joint O, as in the thesis. More are the middles of as many equal parts of the rubber's
    line from tip A over O to tip B.
    """
    if points == 1:
        return (bodies[0].first_end,)
    reach = bodies[0].length_m, bodies[1].length_m
    part = (reach[0] + reach[1]) / points
    return tuple(_pin(bodies, reach[0] - (index + 0.5) * part) for index in range(points))


def _pin(bodies: tuple[Body, Body], from_joint_m: float) -> Pin:
    """Return the place at a distance from O, positive towards tip A."""
    body = bodies[0] if from_joint_m >= 0.0 else bodies[1]
    return body.name, (math.fabs(from_joint_m) - body.length_m / 2.0, 0.0)
