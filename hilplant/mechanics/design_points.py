"""Design points as they are written down, checked and laid into the plane."""

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.mechanics.planar import Point

#: Points on a line define no plane, whose second extent is below this share of the first.
_LEAST_WIDTH = 0.02
#: Of a tilted plane the thickness is below this share of how far the tilt takes its width out of XY.
_THICKNESS = 0.3


class GeometryError(Failure):
    """Design points from which no working mechanism can be built.

    Attributes
    ----------
    part
        Where in the description the fault lies, as the keys that lead there, if it lies in one place.

    """

    def __init__(self, text: str, *part: str | int) -> None:
        """Keep the text, and the keys that lead to the part of the description it is about."""
        super().__init__(text)
        self.part = part


def plane_points(owner: str, names: Iterable[str], written: Mapping[str, Sequence[float]]) -> tuple[Point, ...]:
    """Return the points [m] in the order of their `names`.

    A third coordinate is left out: the plane is seen along Z. What is lost is the length that a link gains by
    leaning out of the plane, and with it the thesis' three-dimensional lengths in (4.24); links that lie in
    parallel planes, as in the linkages of the thesis, lose nothing. :func:`projection_loss` says how much it is.

    Raises
    ------
    GeometryError
        For a point that is missing, unknown or not two or three finite numbers.

    """
    if set(written) != set(names):
        raise GeometryError(f"{owner}: needs the points {', '.join(names)}, has {', '.join(written) or 'none'}")
    return tuple(_plane_point(f"{owner}: point {name}", written[name]) for name in names)


def named_points(owner: str, names: Iterable[str], written: Mapping[str, Sequence[float]]) -> dict[str, Point]:
    """Return what :func:`plane_points` returns, by name."""
    return dict(zip(names, plane_points(owner, names, written), strict=True))


def projection_loss(
    written: Mapping[str, Sequence[float]], body_points: Mapping[str, Sequence[str]]
) -> dict[str, float]:
    """Return the length [m] that each body loses at most when its points are laid into the plane.

    Of all pairs of points on the body, the largest difference between their distance in space, as in (4.24), and
    in the plane. Zero for bodies that lie parallel to the plane, and for points written with two coordinates.

    Parameters
    ----------
    written
        Points as for :func:`plane_points`, already checked.
    body_points
        Names of the points on each body, as `Linkage.body_points`.

    """
    spatial = {name: (*point, 0.0)[:3] for name, point in written.items()}
    return {
        body: max((_lost(spatial[first], spatial[second]) for first, second in combinations(names, 2)), default=0.0)
        for body, names in body_points.items()
    }


def tilt_of(groups: Iterable[Mapping[str, Sequence[float]]]) -> float:
    """Return the angle [rad] between Z and the normal of the plane in which the points lie; 0 where they lie in none.

    Each group has an origin of its own, and all have the same axes. Links in layers along Z are no tilt: the plane that
    fits best must be clearly more tilted than it is thick.

    Parameters
    ----------
    groups
        Points by name, as for :func:`plane_points`, already checked.

    """
    centred = [_centred([(*point, 0.0)[:3] for point in group.values()]) for group in groups if group]
    _, sizes, axes = np.linalg.svd(np.concatenate(centred), full_matrices=False)
    if len(sizes) < 3 or sizes[1] <= _LEAST_WIDTH * sizes[0]:
        return 0.0
    tilt = math.acos(min(1.0, abs(float(axes[2, 2]))))
    return tilt if sizes[2] < _THICKNESS * math.sin(tilt) * sizes[1] else 0.0


def _centred(points: Sequence[Sequence[float]]) -> Floats:
    rows = np.array(points, dtype=np.float64)
    return np.asarray(rows - rows.mean(axis=0))


def _lost(first: Sequence[float], second: Sequence[float]) -> float:
    return math.dist(first, second) - math.dist(first[:2], second[:2])


def rockers_by_side(owner: str, points: Mapping[str, Point], pivots: str) -> tuple[tuple[str, str], tuple[str, str]]:
    """Name two rockers by where they are, from the names of their pivots, one letter each.

    Returns
    -------
    tuple
        The bodies' names in the order of `pivots`, and the pivots' names in the order left, right.

    Raises
    ------
    GeometryError
        When neither pivot is to the left of the other.

    """
    first, second = (points[name][0] for name in pivots)
    if first == second:
        raise GeometryError(
            f"{owner}: the pivots {pivots[0]} and {pivots[1]} both have x = {first:.4g} m, "
            "but the left rocker's must be less than the right one's"
        )
    if first < second:
        return ("left_rocker", "right_rocker"), (pivots[0], pivots[1])
    return ("right_rocker", "left_rocker"), (pivots[1], pivots[0])


def _plane_point(owner: str, written: Sequence[float]) -> Point:
    if len(written) not in (2, 3) or not all(math.isfinite(value) for value in written):
        raise GeometryError(f"{owner} must be [x, y] or [x, y, z] in metres, not {list(written)}")
    return float(written[0]), float(written[1])


def refuse_coincident(owner: str, points: Mapping[str, Point], links: Sequence[str]) -> None:
    """Refuse links, each named by its two points, that have no length."""
    for link in links:
        if points[link[0]] == points[link[1]]:
            raise GeometryError(f"{owner}: {link[0]} and {link[1]} are one point, {link} needs a length")
