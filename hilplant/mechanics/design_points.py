"""Design points as they are written down, checked and laid into the plane."""

import math
from collections.abc import Mapping, Sequence

from hilplant.failure import Failure
from hilplant.mechanics.planar import Point


class GeometryError(Failure):
    """Design points from which no working mechanism can be built."""


def plane_points(owner: str, names: str, written: Mapping[str, Sequence[float]]) -> tuple[Point, ...]:
    """Return the points [m] in the order of their `names`, one letter each.

    A third coordinate is left out: the plane is seen along Z. What is lost is the length that a link gains by
    leaning out of the plane, and with it the thesis' three-dimensional lengths in (4.24); links that lie in
    parallel planes, as in the linkages of the thesis, lose nothing.

    Raises
    ------
    GeometryError
        For a point that is missing, unknown or not two or three finite numbers.

    """
    if set(written) != set(names):
        raise GeometryError(
            f"{owner}: needs the points {', '.join(names)}, has {', '.join(written) or 'none'}"
        )
    return tuple(_plane_point(f"{owner}: point {name}", written[name]) for name in names)


def _plane_point(owner: str, written: Sequence[float]) -> Point:
    if len(written) not in (2, 3) or not all(math.isfinite(value) for value in written):
        raise GeometryError(f"{owner} must be [x, y] or [x, y, z] in metres, not {list(written)}")
    return float(written[0]), float(written[1])


def refuse_coincident(owner: str, points: Mapping[str, Point], links: Sequence[str]) -> None:
    """Refuse links, each named by its two points, that have no length."""
    for link in links:
        if points[link[0]] == points[link[1]]:
            raise GeometryError(f"{owner}: {link[0]} and {link[1]} are one point, {link} needs a length")
