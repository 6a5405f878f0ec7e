"""Whether a linkage of four-bar loops can make its turn, from the lengths of its links, section 4.2.1.

A loop is named by its four points, the two fixed ones outside: O-A-B-C has the crank OA, the coupler AB, the
rocker BC and the ground OC. A crank loop is checked by Grashof's law, a loop between two rockers by whether its
moving pin and its pivot stay within reach of each other. The thesis sweeps the crank for the second, (4.27)-
(4.32); here the two ends of the sweep are taken from the crank's dead centres, where the triangle O-B-C gives
them exactly. Beyond the thesis, the crank must be the shortest link, equality is refused (at a change point the
links lie in one line and the positions are not settled), and the pin must not come nearer to the pivot than the
difference of link and rocker.
"""

import math
from collections.abc import Mapping

from hilplant.mechanics.design_points import GeometryError
from hilplant.mechanics.planar import Point, direction
from hilplant.units import TURN_RAD

Points = Mapping[str, Point]


def check_crank(points: Points, loop: str = "OABC") -> None:
    """Refuse a loop in which the crank cannot turn fully while the rocker rocks, (4.24)-(4.26)."""
    ground, crank, coupler, rocker = crank_loop_links(loop)
    lengths = {link: _length(points, link) for link in (ground, crank, coupler, rocker)}
    shortest, p, q, longest = sorted(lengths, key=lambda link: lengths[link])
    remedy = _crank_remedy(lengths, crank)
    if shortest != crank:
        raise GeometryError(
            f"linkage: the crank {crank} ({lengths[crank]:.4g} m) must be the shortest of {', '.join(lengths)} "
            f"for {rocker} to rock, but {shortest} is ({lengths[shortest]:.4g} m): {remedy}"
        )
    extremes, others = lengths[shortest] + lengths[longest], lengths[p] + lengths[q]
    if extremes >= others:
        raise GeometryError(
            f"linkage: the crank {crank} cannot turn fully: {shortest} + {longest} = {extremes:.4g} m must be "
            f"less than {p} + {q} = {others:.4g} m (Grashof): {remedy}"
        )


def check_reach(points: Points, rocker_loop: str, reached: tuple[float, float]) -> None:
    """Refuse a loop between rockers that its link cannot close over the whole sweep of the first, (4.33).

    Parameters
    ----------
    points
        Design points, from which link and rocker have their lengths.
    rocker_loop
        Its pivot, moving pin, joint and far pivot.
    reached
        From :func:`reach`.

    """
    _, pin, joint, far_pivot = tuple(rocker_loop)
    link, rocker = pin + joint, joint + far_pivot
    nearest, farthest = reached
    spread, least = _length(points, link) + _length(points, rocker), _length(points, link) - _length(points, rocker)
    remedy = _reach_remedy(points, link, rocker, reached)
    if farthest >= spread:
        raise GeometryError(
            f"linkage: the rocker {rocker} cannot follow: {pin} and {far_pivot} are up to {farthest:.4g} m apart, "
            f"which must be less than {link} + {rocker} = {spread:.4g} m: {remedy}"
        )
    if nearest <= abs(least):
        raise GeometryError(
            f"linkage: the rocker {rocker} cannot follow: {pin} and {far_pivot} come as near as {nearest:.4g} m, "
            f"which must be more than |{link} - {rocker}| = {abs(least):.4g} m: {remedy}"
        )


def reach(points: Points, crank_loop: str = "OABC", rocker_loop: str = "CDEF") -> tuple[float, float]:
    """Return the least and the greatest distance between moving pin and far pivot over a turn [m]."""
    pivot, pin, _, far_pivot = tuple(rocker_loop)
    arm, ground = _length(points, pivot + pin), _length(points, pivot + far_pivot)
    low, high = _swept_angle(points, crank_loop, rocker_loop)
    inside = [turn * math.pi for turn in range(-3, 4) if low < turn * math.pi < high]
    angles = (low, *inside, high)
    distances = [math.sqrt(arm**2 + ground**2 - 2.0 * arm * ground * math.cos(angle)) for angle in angles]  # (4.32)
    return min(distances), max(distances)


def dead_centre_angles(points: Points, loop: str = "OABC") -> tuple[float, float]:
    """Return the angle O-C-B [rad] where crank and coupler lie folded and where they lie stretched."""
    oc, oa, ab, bc = (_length(points, link) for link in crank_loop_links(loop))
    folded, stretched = ((oc**2 + bc**2 - ob**2) / (2.0 * oc * bc) for ob in (ab - oa, ab + oa))
    return math.acos(folded), math.acos(stretched)


def crank_loop_links(loop: str) -> tuple[str, str, str, str]:
    """Return ground, crank, coupler and rocker of a crank loop, each by its two points."""
    centre, pin, joint, pivot = tuple(loop)
    return centre + pivot, centre + pin, pin + joint, joint + pivot


def _swept_angle(points: Points, crank_loop: str, rocker_loop: str) -> tuple[float, float]:
    """Return the least and the greatest angle from CF to CD [rad], theta_3 of (4.31), over a turn."""
    centre, _, joint, pivot = tuple(crank_loop)
    at_design = _turn(points, rocker_loop[0] + rocker_loop[3], rocker_loop[0] + rocker_loop[1])
    rocker = _turn(points, pivot + centre, pivot + joint)
    side = math.copysign(1.0, rocker)  # B stays on its side of OC: it cannot cross without OA + AB or AB - OA
    ends = [at_design + side * (angle - abs(rocker)) for angle in dead_centre_angles(points, crank_loop)]
    return min(ends), max(ends)


def _crank_remedy(lengths: Mapping[str, float], crank: str) -> str:
    """Say which crank would do, the other links being as they are."""
    p, q, longest = sorted((link for link in lengths if link != crank), key=lambda link: lengths[link])
    others = lengths[p] + lengths[q]
    if lengths[longest] < others:
        return f"shorten {crank} below {others - lengths[longest]:.4g} m"
    return f"no crank would do, first shorten {longest} below {p} + {q} = {others:.4g} m"


def _reach_remedy(points: Points, link: str, rocker: str, reached: tuple[float, float]) -> str:
    """Say which link would do, the rocker being as it is."""
    nearest, farthest = reached
    length = _length(points, rocker)
    low, high = max(farthest - length, length - nearest), nearest + length
    if low < high:
        return f"{link} between {low:.4g} and {high:.4g} m would do"
    return f"no {link} would do, first make {rocker} longer than {(farthest - nearest) / 2.0:.4g} m"


def _turn(points: Points, start: str, end: str) -> float:
    """Return the angle between two directions, each named by its two points, in (-pi, pi] [rad]."""
    difference = direction(*(points[name] for name in end)) - direction(*(points[name] for name in start))
    return math.remainder(difference, TURN_RAD)


def _length(points: Points, link: str) -> float:
    return math.dist(points[link[0]], points[link[1]])
