"""Wiper arms: rigid bodies in a row on their rocker, section 4.2.2."""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise

from hilplant.mechanics.design_points import plane_points, refuse_coincident
from hilplant.mechanics.planar import (
    Body,
    Driving,
    Ground,
    Joint,
    Mechanism,
    Point,
    Revolute,
    Rigid,
    direction,
)
from hilplant.models.records import Arm

#: Design points of each kind of arm; the first is the pivot, the last carries the blade.
ARM_POINTS = {"straight": "OABC", "bent": "OAB"}


def arm_points(kind: str, written: Mapping[str, Sequence[float]]) -> tuple[Point, ...]:
    """Return the points [m] of a `straight` or `bent` arm, seen from its pivot O, at the design position.

    Raises
    ------
    GeometryError
        For points that are missing, not numbers, or one on the other.

    """
    names = ARM_POINTS[kind]
    points = plane_points(f"{kind} arm", names, written)
    links = [names[index : index + 2] for index in range(len(names) - 1)]
    refuse_coincident(f"{kind} arm", dict(zip(names, points, strict=True)), [*links, names[0] + names[-1]])
    return points


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


def arm_mechanism(points: Sequence[Point]) -> Mechanism:
    """Return the arm's bodies, rigidly joined, the first one driven about the pivot, (4.35), (4.38)."""
    pairs = pairwise(points)
    bodies = [Body.between(f"body {index}", *ends) for index, ends in enumerate(pairs, start=1)]
    joints: list[Joint] = [
        Ground("ground"),
        Revolute(("ground", points[0]), bodies[0].first_end),
        Driving(bodies[0].name),
    ]
    for inner, outer in pairwise(bodies):
        bend = outer.angle_rad - inner.angle_rad
        joints.append(Rigid(inner.second_end, outer.first_end, bend))
    return Mechanism([Body.ground(), *bodies], joints)
