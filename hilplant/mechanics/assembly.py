"""Any planar linkage of one degree of freedom, from a description of its bodies and joints.

The description as a file says it::

    kind: assembly
    points_m: {O: [0, 0], A: [0.0445, 0.0055], B: [-0.224, -0.0218], C: [-0.272, 0.027], ...}
    bodies: # two or more points each; the first two give the body's angle, its length and its origin half-way
      crank: [O, A]
      coupler: [A, B]
      left_rocker: [B, C, D]
      link: [D, E]
      right_rocker: [E, F]
    joints: # a point, and two or more bodies that share it; `ground` is the base and has every point
      - {revolute: O, bodies: [ground, crank]}
      - {revolute: A, bodies: [crank, coupler]}
      - ...
      - {rigid: P, bodies: [left_rocker, bracket]}
      - {ground: frame} # a body that stays where it is
    crank: crank # names of three bodies; these are what they are when left out
    left_rocker: left_rocker
    right_rocker: right_rocker

The crank must turn about a point of the ground, and so must both rockers, which carry the arms.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from hilplant.mechanics.design_points import GeometryError, named_points
from hilplant.mechanics.joining import Meeting, Plan, joined
from hilplant.mechanics.linkage import Linkage
from hilplant.mechanics.planar import Point
from hilplant.mechanics.structure import check_structure
from hilplant.mechanics.transmission import check_rocking

_JOINTS = ("revolute", "rigid", "ground")


@dataclass(frozen=True, slots=True)
class Description:
    """A linkage as it is written down; see the file shape at the top.

    Attributes
    ----------
    points
        Design points by name, each [x, y] or [x, y, z] in metres.
    bodies
        Names of the points on each body.
    joints
        Mappings with one of the keys `revolute`, `rigid` (a point's name) or `ground` (a body's), the first two
        with the key `bodies` beside it.
    crank, left_rocker, right_rocker
        Names of these bodies.

    """

    points: Mapping[str, Sequence[float]]
    bodies: Mapping[str, Sequence[str]]
    joints: Sequence[Mapping[str, Any]]
    crank: str = "crank"
    left_rocker: str = "left_rocker"
    right_rocker: str = "right_rocker"


def assembly(description: Description) -> Linkage:
    """Return the linkage that a description describes.

    Raises
    ------
    GeometryError
        For names that are not there, bodies without length, bodies hanging on nothing, a count of joints that
        leaves other than one degree of freedom, bodies held more than once, a start in a dead point, a crank
        that cannot make its turn and a rocker that goes round with it.

    """
    points = named_points("linkage", description.points, description.points)
    _check_bodies(description, points)
    meetings, fixed = _meetings(description)
    pivots = _named_pivots(description, points, meetings)
    linkage = joined(
        Plan(
            "assembly",
            points,
            description.bodies,
            meetings,
            pivots,
            description.crank,
            description.left_rocker,
            description.right_rocker,
            fixed,
        )
    )
    check_structure(linkage)
    check_rocking(linkage)
    return linkage


def _check_bodies(description: Description, points: Mapping[str, Point]) -> None:
    """Refuse bodies whose points are missing or one on the other, and points that are on no body."""
    for body, names in description.bodies.items():
        if body == "ground":
            raise GeometryError("body ground: is there already, give yours another name", "bodies", body)
        if not isinstance(names, Sequence) or isinstance(names, str) or len(names) < 2:
            raise GeometryError(f"body {body}: needs two points or more, as [A, B]", "bodies", body)
        for name in names:
            if name not in points:
                raise GeometryError(f"body {body}: {_unknown('point', name, points)}", "bodies", body)
        for first, second in combinations(names, 2):
            if points[first] == points[second]:
                text = f"body {body}: {first} and {second} are one point, a body needs a length between its points"
                raise GeometryError(text, "bodies", body)
    used = {name for names in description.bodies.values() for name in names}
    if unused := [name for name in points if name not in used]:
        raise GeometryError(f"point {unused[0]}: is on no body", "points_m", unused[0])


def _meetings(description: Description) -> tuple[list[Meeting], tuple[str, ...]]:
    """Return joints pair by pair, and the bodies that stay where they are."""
    meetings: list[Meeting] = []
    fixed: list[str] = []
    for index, joint in enumerate(description.joints):
        try:
            kind = _joint_kind(joint)
            if kind == "ground":
                fixed.append(_known_body(description, joint[kind]))
            else:
                meetings += _pairs(description, joint, kind)
        except GeometryError as error:
            raise GeometryError(f"joint {index + 1}: {error}", "joints", index) from None
    return meetings, tuple(fixed)


def _joint_kind(joint: Mapping[str, Any]) -> str:
    kinds = [key for key in _JOINTS if isinstance(joint, Mapping) and key in joint]
    wanted = {kinds[0]} | ({"bodies"} if kinds[0] != "ground" else set()) if len(kinds) == 1 else set()
    if len(kinds) != 1 or set(joint) != wanted:
        shapes = "{revolute: A, bodies: [crank, coupler]}, {rigid: P, bodies: [...]} or {ground: frame}"
        raise GeometryError(f"must be {shapes}, not {joint}")
    return kinds[0]


def _pairs(description: Description, joint: Mapping[str, Any], kind: str) -> list[Meeting]:
    """Return a joint of two or more bodies as joints of the first with each of the others."""
    point, bodies = joint[kind], joint["bodies"]
    if not isinstance(bodies, list | tuple) or len(bodies) < 2 or len(set(map(str, bodies))) < len(bodies):
        raise GeometryError(f"needs two bodies or more, each once, not {bodies}")
    if point not in description.points:
        raise GeometryError(_unknown("point", point, description.points))
    for body in bodies:
        if body != "ground" and point not in description.bodies[_known_body(description, body)]:
            raise GeometryError(f"point {point} is not on body {body}, which has {', '.join(description.bodies[body])}")
    return [Meeting(point, bodies[0], other, kind == "rigid") for other in bodies[1:]]


def _known_body(description: Description, name: Any) -> str:
    if name not in description.bodies:
        raise GeometryError(_unknown("body", name, ("ground", *description.bodies)))
    return str(name)


def _named_pivots(
    description: Description, points: Mapping[str, Point], meetings: Sequence[Meeting]
) -> tuple[str, str]:
    """Return the names of the rockers' pivots; refuse crank and rockers that turn about no point of the ground."""
    pivots = {}
    for role in ("crank", "left_rocker", "right_rocker"):
        body = getattr(description, role)
        if body not in description.bodies:
            raise GeometryError(f"{role}: {_unknown('body', body, description.bodies)}", role)
        about = [met.point for met in meetings if not met.rigid and {met.first, met.second} == {"ground", body}]
        if len(about) != 1:
            raise GeometryError(f"{role}: body {body} must turn about one point of the ground, not {len(about)}", role)
        pivots[role] = about[0]
    if len({description.crank, description.left_rocker, description.right_rocker}) < 3:
        raise GeometryError("crank, left_rocker and right_rocker must be three bodies", "bodies")
    left, right = pivots["left_rocker"], pivots["right_rocker"]
    if points[left][0] >= points[right][0]:
        raise GeometryError(
            f"left_rocker: its pivot {left} (x = {points[left][0]:.4g} m) must lie to the left of "
            f"the right rocker's, {right} (x = {points[right][0]:.4g} m)",
            "left_rocker",
        )
    return left, right


def _unknown(what: str, name: Any, known: Any) -> str:
    return f"there is no {what} {name}, only {', '.join(known)}"
