"""The master-driven linkage of Appendix C.1: the crank swings one rocker, a link from the same pin the other."""

from collections.abc import Mapping, Sequence

from hilplant.mechanics.design_points import named_points, refuse_coincident, rockers_by_side
from hilplant.mechanics.feasibility import check_crank, check_reach, reach
from hilplant.mechanics.joining import Meeting, Plan, joined
from hilplant.mechanics.linkage import Linkage


def master_driven(written: Mapping[str, Sequence[float]]) -> Linkage:
    """Return the linkage with the points O to E, each [x, y] or [x, y, z] in metres.

    The crank OA turns about O, the coupler AB swings the rocker BC about C, the link BD takes its motion from
    B, where coupler and rocker meet, to the rocker DE about E. In a car with the wheel on the right, BC is the
    right rocker, the driver's, the master; with the wheel on the left it is the left one. Bodies and joints are
    in the order of (9.1) and (9.3).

    Raises
    ------
    GeometryError
        For points that are missing or not numbers, and for a linkage that cannot make its turn.

    """
    points = named_points("linkage", "OABCDE", written)
    refuse_coincident("linkage", points, ("OA", "AB", "BC", "BD", "DE", "CE", "OC"))
    (driven, follower), pivots = rockers_by_side("linkage", points, "CE")
    check_crank(points, "OABC")
    check_reach(points, "CBDE", reach(points, "OABC", "CBDE"))
    bodies = {"crank": "OA", "coupler": "AB", driven: "BC", "link": "BD", follower: "DE"}
    meetings = (
        Meeting("O", "ground", "crank"),
        Meeting("A", "crank", "coupler"),
        Meeting("B", "coupler", driven),
        Meeting("C", driven, "ground"),
        Meeting("B", "coupler", "link"),
        Meeting("D", "link", follower),
        Meeting("E", follower, "ground"),
    )
    return joined(Plan("master_driven", points, bodies, meetings, pivots))
