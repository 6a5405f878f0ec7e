"""Wiper arms: their design points, and what the step needs of them, section 4.2.2."""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise

from hilplant.mechanics.design_points import GeometryError, plane_points, refuse_coincident
from hilplant.mechanics.planar import Point, direction
from hilplant.models.records import Arm

#: Design points of each kind of arm; the first is the pivot, the last carries the blade.
ARM_POINTS = {"straight": "OABC", "bent": "OAB"}

#: From one rod of an arm to the next [deg]; the arms of the thesis bend by 46 deg at most.
SHARPEST_BEND_DEG = 120.0


def arm_points(kind: str, written: Mapping[str, Sequence[float]]) -> tuple[Point, ...]:
    """Return the points [m] of a `straight` or `bent` arm, seen from its pivot O, at the design position.

    Raises
    ------
    GeometryError
        For points that are missing, not numbers, or one on the other, and for an arm that turns back on itself, as
        one does of which a sign is missing.

    """
    names = ARM_POINTS[kind]
    points = plane_points(f"{kind} arm", names, written)
    links = [names[index : index + 2] for index in range(len(names) - 1)]
    refuse_coincident(f"{kind} arm", dict(zip(names, points, strict=True)), [*links, names[0] + names[-1]])
    _refuse_turning_back(f"{kind} arm", links, points)
    return points


def _refuse_turning_back(owner: str, links: Sequence[str], points: Sequence[Point]) -> None:
    directions = [direction(first, second) for first, second in pairwise(points)]
    for (before, link), (one, other) in zip(pairwise(links), pairwise(directions), strict=True):
        bend = math.degrees(abs(math.remainder(other - one, math.tau)))
        if bend > SHARPEST_BEND_DEG:
            text = f"{owner}: {link} turns back on {before} by {bend:.0f} deg, must be at most {SHARPEST_BEND_DEG:g}"
            raise GeometryError(f"{text}: check the signs of {link[1]}")


def arm(points: Sequence[Point], rocker_angle_at_design_rad: float) -> Arm:
    """Return the arm as the step needs it.

    Parameters
    ----------
    points
        From :func:`arm_points`.
    rocker_angle_at_design_rad
        The rocker's angle at crank angle 0 [rad], the first knot of its table.

    Returns
    -------
    Arm
        The angle of the arm's first body from +X at the design position less the rocker's, theta_o of (4.35)
        and (4.38), and the distance from the pivot to the blade's joint. The way to that joint lies at a
        fixed angle to the first body.

    """
    offset = direction(points[0], points[1]) - float(rocker_angle_at_design_rad)
    return Arm(offset, math.dist(points[0], points[-1]))
