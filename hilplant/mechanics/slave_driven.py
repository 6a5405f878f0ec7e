"""The slave-driven linkage of Figure 4-2: the crank swings one rocker, a link from that rocker the other."""

from collections.abc import Mapping, Sequence

from hilplant.mechanics.design_points import named_points, refuse_coincident, rockers_by_side
from hilplant.mechanics.feasibility import check_crank, check_reach, reach
from hilplant.mechanics.joining import Meeting, Plan, joined, straightened
from hilplant.mechanics.linkage import Linkage


def slave_driven(written: Mapping[str, Sequence[float]]) -> Linkage:
    """Return the linkage with the points O to F, each [x, y] or [x, y, z] in metres.

    The crank OA turns about O, the coupler AB swings the rocker BC about C, the link DE takes its motion from D
    on that rocker to the rocker EF about F. In a car with the wheel on the right, BC is the left rocker, the
    passenger's, the slave of the driver's; with the wheel on the left it is the right one. Bodies and joints
    are in the order of (4.1) and (4.11).

    Raises
    ------
    GeometryError
        For points that are missing or not numbers, and for a linkage that cannot make its turn.

    """
    points = named_points("linkage", "OABCDEF", written)
    refuse_coincident("linkage", points, ("OA", "AB", "BC", "CD", "DE", "EF", "FC", "OC"))
    (driven, follower), pivots = rockers_by_side("linkage", points, "CF")
    check_crank(points, "OABC")
    meant = {**points, "D": straightened(points, "BCD")}
    check_reach(points, "CDEF", reach(meant, "OABC", "CDEF"))
    bodies = {"crank": "OA", "coupler": "AB", driven: "BCD", "link": "DE", follower: "EF"}
    meetings = (
        Meeting("O", "ground", "crank"),
        Meeting("A", "crank", "coupler"),
        Meeting("B", "coupler", driven),
        Meeting("C", driven, "ground"),
        Meeting("D", "link", driven),
        Meeting("E", "link", follower),
        Meeting("F", follower, "ground"),
    )
    return joined(Plan("slave_driven", points, bodies, meetings, pivots))
