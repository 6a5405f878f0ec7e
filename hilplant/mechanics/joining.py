"""Bodies laid through named design points and joined where they share one."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from hilplant.mechanics.linkage import Linkage
from hilplant.mechanics.planar import Body, Driving, Ground, Joint, Pin, Point, Revolute, Rigid

#: Design points come rounded to this; a body whose third point is on a line with its first two but for it is
#: straight.
RESOLUTION_M = 1e-4


class Meeting(NamedTuple):
    """Two bodies that share a design point; they turn about it unless they are rigidly joined."""

    point: str
    first: str
    second: str
    rigid: bool = False


@dataclass(frozen=True, slots=True)
class Plan:
    """A linkage by the names of its points.

    Attributes
    ----------
    kind
        Name of the linkage's kind.
    points
        Design points by name [m].
    body_points
        The points on each moving body, two or more, in the order of the bodies' coordinates.
    meetings
        In the order of their equations, between the ground's and the drive's.
    rocker_pivots
        Names of the points about which the left and the right rocker turn.
    crank, left_rocker, right_rocker
        Names of these bodies.
    fixed
        Names of bodies that stay where they are.

    """

    kind: str
    points: Mapping[str, Point]
    body_points: Mapping[str, Sequence[str]]
    meetings: Sequence[Meeting]
    rocker_pivots: tuple[str, str]
    crank: str = "crank"
    left_rocker: str = "left_rocker"
    right_rocker: str = "right_rocker"
    fixed: tuple[str, ...] = ()


def joined(plan: Plan) -> Linkage:
    """Return the linkage: each body lies from its first point to its second, origin half-way, (4.10)."""
    bodies = {name: _body(plan, name) for name in plan.body_points}
    on_ground = dict.fromkeys(met.point for met in plan.meetings if "ground" in (met.first, met.second))
    joints = [_joint(plan, bodies, meeting) for meeting in plan.meetings]
    left, right = (plan.points[name] for name in plan.rocker_pivots)
    return Linkage(
        plan.kind,
        plan.points,
        (Body.ground(), *bodies.values()),
        (Ground("ground"), *map(Ground, plan.fixed), *joints, Driving(plan.crank)),
        {"ground": tuple(on_ground), **{body: tuple(names) for body, names in plan.body_points.items()}},
        left,
        right,
        plan.crank,
        plan.left_rocker,
        plan.right_rocker,
    )


def _body(plan: Plan, name: str) -> Body:
    first, second = (plan.points[point] for point in plan.body_points[name][:2])
    return Body.between(name, first, second)


def _joint(plan: Plan, bodies: Mapping[str, Body], meeting: Meeting) -> Joint:
    first, second = (_pin(plan, bodies, body, meeting.point) for body in (meeting.first, meeting.second))
    if not meeting.rigid:
        return Revolute(first, second)
    angles = [bodies[body].angle_rad if body in bodies else 0.0 for body in (meeting.first, meeting.second)]
    return Rigid(first, second, angles[1] - angles[0])


def _pin(plan: Plan, bodies: Mapping[str, Body], body: str, point: str) -> Pin:
    """Return a design point in a body's own coordinates."""
    if body == "ground":
        return body, plan.points[point]
    first, second, *_ = plan.body_points[body]
    if point in (first, second):
        return bodies[body].first_end if point == first else bodies[body].second_end
    return body, bodies[body].local(straightened(plan.points, (first, second, point)))


def straightened(points: Mapping[str, Point], names: Sequence[str]) -> Point:
    """Return the third of three named points, moved onto the line of the first two where that is what is meant.

    (4.10) puts D of the slave-driven linkage on the line through B and C at its distance from C. Where the
    points say so but for their rounding, that is what is meant; a point farther from the line stays where it is.
    """
    first, second, third = (complex(*points[name]) for name in names)
    along = (third - second) * (first - second).conjugate() / abs(first - second)
    if abs(along.imag) > RESOLUTION_M:
        return points[names[2]]
    meant = second + math.copysign(abs(along), along.real) * (first - second) / abs(first - second)
    return meant.real, meant.imag
