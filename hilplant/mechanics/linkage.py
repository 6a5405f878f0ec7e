"""The slave-driven linkage, and its rockers tabulated over the crank angle."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hilplant.mechanics.design_points import plane_points, refuse_coincident
from hilplant.mechanics.feasibility import check_crank, check_reach
from hilplant.mechanics.newton_raphson import SolutionError, follow, rates
from hilplant.mechanics.planar import Body, Driving, Floats, Ground, Mechanism, Point, Revolute, direction
from hilplant.units import TURN_RAD

#: Design points come rounded to this; a rocker whose three points are on a line but for it is straight.
RESOLUTION_M = 1e-4
#: How well the angles must come back after a turn, before the last knot is set equal to the first.
CLOSURE_RAD = 1e-9


@dataclass(frozen=True, slots=True)
class SlaveDrivenLinkage:
    """Joints of the six-bar linkage of Figure 4-2 at the design position [m], Z towards the reader.

    The crank OA turns about O, the coupler AB swings the left rocker BC about C, the link DE takes its motion
    from D on that rocker to the right rocker EF about F. Build it with :meth:`from_points`, which checks that
    it can work.
    """

    o: Point
    a: Point
    b: Point
    c: Point
    d: Point
    e: Point
    f: Point

    @classmethod
    def from_points(cls, written: Mapping[str, Sequence[float]]) -> "SlaveDrivenLinkage":
        """Return the linkage with the points O to F, each [x, y] or [x, y, z] in metres.

        Raises
        ------
        GeometryError
            For points that are missing or not numbers, and for a linkage that cannot make its turn.

        """
        points = dict(zip("OABCDEF", plane_points("linkage", "OABCDEF", written), strict=True))
        refuse_coincident("linkage", points, ("OA", "AB", "BC", "CD", "DE", "EF", "FC", "OC"))
        check_crank(points)
        check_reach(points)
        return cls(*points.values())

    @property
    def design_crank_angle_rad(self) -> float:
        """The crank's angle from +X at the design position, theta_0 of (4.9)."""
        return direction(self.o, self.a)

    def mechanism(self) -> Mechanism:
        """Return the six bodies and their joints in the order of (4.1) and (4.11), driven by the crank."""
        crank, coupler = Body.between("crank", self.o, self.a), Body.between("coupler", self.a, self.b)
        left, link = Body.between("left_rocker", self.b, self.c), Body.between("link", self.d, self.e)
        right = Body.between("right_rocker", self.e, self.f)
        joints = (
            Ground("ground"),
            Revolute(("ground", self.o), crank.first_end),
            Revolute(crank.second_end, coupler.first_end),
            Revolute(coupler.second_end, left.first_end),
            Revolute(left.second_end, ("ground", self.c)),
            Revolute(link.first_end, ("left_rocker", self._link_on_rocker(left))),
            Revolute(link.second_end, right.first_end),
            Revolute(right.second_end, ("ground", self.f)),
            Driving("crank"),
        )
        return Mechanism((Body.ground(), crank, coupler, left, link, right), joints)

    def _link_on_rocker(self, rocker: Body) -> Point:
        """Return D in the rocker's own coordinates.

        (4.10) puts it on the line through B and C at its distance from C. Where the points say so but for
        their rounding, that is what is meant; a D farther from the line stays where it is.
        """
        along, across = rocker.local(self.d)
        if abs(across) > RESOLUTION_M:
            return along, across
        pivot = rocker.length_m / 2.0
        return pivot + math.copysign(math.dist(self.c, self.d), along - pivot), 0.0


def rocker_tables(linkage: SlaveDrivenLinkage, knots: int = 1024) -> Floats:
    """Tabulate both rockers over one turn of the crank.

    The crank turns anticlockwise from the design position, which is crank angle 0. A rocker's angle is the
    thesis' body angle from +X: that of the way from B to C on the left, from E to F on the right, in (-pi,
    pi] at the design position and without jumps from there.

    Parameters
    ----------
    linkage
        A linkage that has passed the checks of `from_points`.
    knots
        Equal steps in a turn.

    Returns
    -------
    ndarray of shape [2, knots + 1, 2]
        Left and right rocker; knot; angle [rad] and its derivative by the crank angle [rad/rad]. The last
        knot equals the first.

    Raises
    ------
    SolutionError
        When a position is not found, or a rocker does not come back to where it began.

    """
    mechanism = linkage.mechanism()
    crank_rad = linkage.design_crank_angle_rad + np.linspace(0.0, TURN_RAD, knots + 1)
    coordinates = follow(mechanism, crank_rad)
    velocities = rates(mechanism, coordinates)
    rockers = [mechanism.angle(body) for body in ("left_rocker", "right_rocker")]
    tables = np.stack([coordinates[:, rockers].T, velocities[:, rockers].T], axis=-1)
    gap = np.abs(tables[:, -1] - tables[:, 0]).max()
    if gap > CLOSURE_RAD:
        raise SolutionError(f"after one turn of the crank a rocker is {gap:.3g} rad away from where it began")
    tables[:, -1] = tables[:, 0]
    return np.ascontiguousarray(tables)
