"""The centre-driven linkage of Appendix C.2: the crank's one pin swings both rockers, each by its own coupler.

(9.10) prints the second coupler's first end at the fixed point O. Its Jacobian (9.11) has it at the crank's pin,
and only that moves; so it is here.
"""

from collections.abc import Mapping, Sequence

from hilplant.mechanics.design_points import named_points, refuse_coincident, rockers_by_side
from hilplant.mechanics.feasibility import check_crank
from hilplant.mechanics.joining import Meeting, Plan, joined
from hilplant.mechanics.linkage import Linkage


def centre_driven(written: Mapping[str, Sequence[float]]) -> Linkage:
    """Return the linkage with the points O to E, each [x, y] or [x, y, z] in metres.

    The crank OA turns about O; the coupler AB swings the rocker BC about C, the second coupler AD swings the
    rocker DE about E. Which of the rockers is the left one follows from where C and E are. The second coupler
    is the body `link`, as in the other kinds. Bodies and joints are in the order of (9.8) and (9.10).

    Raises
    ------
    GeometryError
        For points that are missing or not numbers, and for a linkage that cannot make its turn.

    """
    points = named_points("linkage", "OABCDE", written)
    refuse_coincident("linkage", points, ("OA", "AB", "BC", "OC", "AD", "DE", "OE"))
    (first, second), pivots = rockers_by_side("linkage", points, "CE")
    check_crank(points, "OABC")
    check_crank(points, "OADE")
    bodies = {"crank": "OA", "coupler": "AB", first: "BC", "link": "AD", second: "DE"}
    meetings = (
        Meeting("O", "ground", "crank"),
        Meeting("A", "crank", "coupler"),
        Meeting("B", "coupler", first),
        Meeting("C", first, "ground"),
        Meeting("A", "crank", "link"),
        Meeting("D", "link", second),
        Meeting("E", second, "ground"),
    )
    return joined(Plan("centre_driven", points, bodies, meetings, pivots))
