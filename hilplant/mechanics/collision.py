"""How near two wipers come to each other over a turn of the crank, seen along Z.

Arms and blades are rows of straight lines that turn with their rockers. Arms pass over each other's blades at
another height, so arm and blade crossing in this view is no collision by itself; two blades lie on the same screen.
What is to be compared, the caller chooses by the lines that he gives.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.mechanics.design_points import GeometryError
from hilplant.mechanics.planar import Point
from hilplant.units import RAD_PER_DEG, TURN_RAD

#: A straight line of a wiper at the design position, seen from the pivot of its rocker [m].
Line = tuple[Point, Point]


@dataclass(frozen=True, slots=True)
class SweepSide:
    """One wiper: its pivot [m], its lines, and its rocker's angle at each crank angle of a turn [rad]."""

    pivot: Point
    lines: Sequence[Line]
    rocker_rad: Floats

    def moved(self) -> Floats:
        """Return the lines' ends [crank angle, line, end] as complex numbers x + i y [m]."""
        ends = np.array([[complex(*first), complex(*second)] for first, second in self.lines])
        turned = np.exp(1j * (self.rocker_rad - self.rocker_rad[0]))
        return np.asarray(complex(*self.pivot) + turned[:, np.newaxis, np.newaxis] * ends)


def clearance(left: SweepSide, right: SweepSide) -> tuple[float, float]:
    """Return the least distance between any two lines of the sides [m], and the crank angle where [rad].

    Zero when lines cross. The turn is looked at where the rocker angles are given, equal steps of the crank, the
    last of them the first again; between two of them a line's end moves on by its radius times the rocker's step.
    """
    first, second = left.moved()[:, :, np.newaxis], right.moved()[:, np.newaxis]
    distances = _distance(first, second).min(axis=(1, 2))
    knot = int(distances.argmin())
    return float(distances[knot]), TURN_RAD * knot / (distances.size - 1)


def check_clearance(left: SweepSide, right: SweepSide, least_m: float) -> float:
    """Refuse wipers that come nearer to each other than `least_m`; return how near they come [m].

    Raises
    ------
    GeometryError
        With the distance, the crank angle and the limit.

    """
    distance, crank_rad = clearance(left, right)
    if distance < least_m:
        what = f"come within {distance:.4g} m of each other" if distance > 0.0 else "cross"
        raise GeometryError(
            f"wipers: left and right {what} at crank angle {crank_rad / RAD_PER_DEG:.1f} deg, "
            f"must stay at least {least_m:.4g} m apart: move the pivots apart or shorten the blades"
        )
    return distance


def _distance(first: Floats, second: Floats) -> Floats:
    """Return the distance of lines given by their two ends in the last axis."""
    to_ends = [_to_line(first[..., end], second) for end in (0, 1)] + [
        _to_line(second[..., end], first) for end in (0, 1)
    ]
    apart = np.minimum.reduce(to_ends)
    crossing = np.logical_and(_parted(first, second), _parted(second, first))
    return np.asarray(np.where(crossing, 0.0, apart))


def _to_line(point: Floats, line: Floats) -> Floats:
    start, way = line[..., 0], line[..., 1] - line[..., 0]
    share = np.clip(((point - start) * way.conj()).real / np.abs(way) ** 2, 0.0, 1.0)
    return np.asarray(np.abs(point - start - share * way))


def _parted(line: Floats, ends: Floats) -> Floats:
    """Return whether two ends lie on different sides of a line produced without end."""
    way = (line[..., 1] - line[..., 0]).conj()
    sides = [(way * (ends[..., end] - line[..., 0])).imag for end in (0, 1)]
    return np.asarray(sides[0] * sides[1] < 0.0)
