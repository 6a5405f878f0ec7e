"""Whether a slave-driven linkage can make its turn, from the lengths of its links, section 4.2.1.

Two loops are checked: the crank-rocker O-A-B-C by Grashof's law, and the double rocker C-D-E-F by whether D
and F stay within reach of each other. The thesis sweeps the crank for the second, (4.27)-(4.32); here the two
ends of the sweep are taken from the crank's dead centres, where the triangle O-B-C gives them exactly. Beyond
the thesis, the crank must be the shortest link, equality is refused (at a change point the links lie in one
line and the positions are not settled), and D must not come nearer to F than the difference of DE and EF.
"""

import math
from collections.abc import Mapping

from hilplant.mechanics.design_points import GeometryError
from hilplant.mechanics.planar import Point, direction
from hilplant.units import TURN_RAD

Points = Mapping[str, Point]


def check_crank(points: Points) -> None:
    """Refuse a loop O-A-B-C in which OA cannot turn fully while BC rocks, (4.24)-(4.26)."""
    lengths = {link: _length(points, link) for link in ("OC", "OA", "AB", "BC")}
    shortest, p, q, longest = sorted(lengths, key=lambda link: lengths[link])
    if shortest != "OA":
        raise GeometryError(
            f"linkage: the crank OA ({lengths['OA']:.4g} m) must be the shortest of OC, OA, AB, BC "
            f"for BC to rock, but {shortest} is ({lengths[shortest]:.4g} m)"
        )
    extremes, others = lengths[shortest] + lengths[longest], lengths[p] + lengths[q]
    if extremes >= others:
        raise GeometryError(
            f"linkage: the crank OA cannot turn fully: {shortest} + {longest} = {extremes:.4g} m must be "
            f"less than {p} + {q} = {others:.4g} m (Grashof)"
        )


def check_reach(points: Points) -> None:
    """Refuse a loop C-D-E-F that DE and EF cannot close over the whole sweep of the rocker, (4.33)."""
    nearest, farthest = reach(points)
    link, rocker = _length(points, "DE"), _length(points, "EF")
    if farthest >= link + rocker:
        raise GeometryError(
            f"linkage: the right rocker cannot follow: D and F are up to {farthest:.4g} m apart, "
            f"which must be less than DE + EF = {link + rocker:.4g} m"
        )
    if nearest <= abs(link - rocker):
        raise GeometryError(
            f"linkage: the right rocker cannot follow: D and F come as near as {nearest:.4g} m, "
            f"which must be more than |DE - EF| = {abs(link - rocker):.4g} m"
        )


def reach(points: Points) -> tuple[float, float]:
    """Return the least and the greatest distance between D and F over a turn of the crank [m]."""
    cd, fc = _length(points, "CD"), _length(points, "FC")
    low, high = _swept_angle(points)
    inside = [turn * math.pi for turn in range(-3, 4) if low < turn * math.pi < high]
    angles = (low, *inside, high)
    distances = [math.sqrt(cd**2 + fc**2 - 2.0 * cd * fc * math.cos(angle)) for angle in angles]  # (4.32)
    return min(distances), max(distances)


def dead_centre_angles(points: Points) -> tuple[float, float]:
    """Return the angle O-C-B [rad] where crank and coupler lie folded and where they lie stretched."""
    oc, oa, ab, bc = (_length(points, link) for link in ("OC", "OA", "AB", "BC"))
    folded, stretched = ((oc**2 + bc**2 - ob**2) / (2.0 * oc * bc) for ob in (ab - oa, ab + oa))
    return math.acos(folded), math.acos(stretched)


def _swept_angle(points: Points) -> tuple[float, float]:
    """Return the least and the greatest angle from CF to CD [rad], theta_3 of (4.31), over a turn."""
    at_design = _turn(points, "CF", "CD")
    rocker = _turn(points, "CO", "CB")
    side = math.copysign(1.0, rocker)  # B stays on its side of OC: it cannot cross without OA + AB or AB - OA
    ends = [at_design + side * (angle - abs(rocker)) for angle in dead_centre_angles(points)]
    return min(ends), max(ends)


def _turn(points: Points, start: str, end: str) -> float:
    """Return the angle between two directions, each named by its two points, in (-pi, pi] [rad]."""
    difference = direction(*(points[name] for name in end)) - direction(*(points[name] for name in start))
    return math.remainder(difference, TURN_RAD)


def _length(points: Points, link: str) -> float:
    return math.dist(points[link[0]], points[link[1]])
