"""How near two wipers come to each other: against distances by brute force, and what is said of a collision."""

import math
import re

import numpy as np
import pytest

from hilplant.mechanics.collision import Line, SweepSide, check_clearance, clearance
from hilplant.mechanics.design_points import GeometryError
from hilplant.units import RAD_PER_DEG, TURN_RAD

KNOTS = 24


def side(pivot: tuple[float, float], lines: list[Line], swing_rad: float) -> SweepSide:
    """Return a wiper that swings clockwise and back over one turn of the crank."""
    crank = np.linspace(0.0, TURN_RAD, KNOTS + 1)
    return SweepSide(pivot, lines, 1.0 - swing_rad * (1.0 - np.cos(crank)) / 2.0)


def test_distances_are_those_of_many_points_along_the_lines() -> None:
    random = np.random.default_rng(1)
    share = np.linspace(0.0, 1.0, 101)
    for _ in range(6):
        pivots, swings = random.normal(0.0, 0.6, (2, 2)), random.uniform(0.5, 2.0, 2)
        ends = random.normal(0.0, 0.4, (2, 2, 2, 2))
        lines = [[(tuple(line[0]), tuple(line[1])) for line in one] for one in ends]
        left, right = (side(tuple(pivots[at]), lines[at], float(swings[at])) for at in (0, 1))  # type: ignore[arg-type]
        distance, _ = clearance(left, right)
        brute = math.inf
        for knot in range(KNOTS + 1):
            rows = []
            for one in (left, right):
                turned = one.rocker_rad[knot] - one.rocker_rad[0]
                turning = np.array([[math.cos(turned), -math.sin(turned)], [math.sin(turned), math.cos(turned)]])
                rows.append(
                    np.concatenate(
                        [
                            np.array(one.pivot) + (np.outer(1 - share, line[0]) + np.outer(share, line[1])) @ turning.T
                            for line in one.lines
                        ]
                    )
                )
            brute = min(brute, float(np.hypot(*(rows[0][:, np.newaxis] - rows[1][np.newaxis]).T).min()))
        assert distance <= brute + 1e-12
        assert brute - distance < max(math.dist(*line) for one in lines for line in one) / 100.0


def test_blades_that_cross_are_refused_with_the_crank_angle() -> None:
    """The left blade swings over from the left to where the right one stands."""
    left = side((0.0, 0.0), [((-0.5, 0.1), (-1.0, 0.1))], 2.5)
    right = side((0.5, 0.0), [((0.0, 0.3), (0.0, 0.9))], 0.0)
    with pytest.raises(GeometryError) as caught:
        check_clearance(left, right, 0.02)
    assert re.match(
        r"wipers: left and right cross at crank angle \d+\.0 deg, must stay at least 0\.02 m apart: move the pivots",
        str(caught.value),
    )
    assert check_clearance(side((0.0, 0.0), left.lines, 0.3), right, 0.02) > 0.5


def test_blades_that_come_too_near_are_refused_with_the_distance() -> None:
    upright: list[Line] = [((0.0, 0.5), (0.0, 1.0))]
    left, right = side((0.0, 0.0), upright, 0.2), side((0.3, 0.0), upright, 0.0)
    distance, crank_rad = clearance(left, right)
    assert distance == pytest.approx(0.3 - math.sin(0.2), abs=1e-12)
    assert crank_rad / RAD_PER_DEG == pytest.approx(180.0)
    with pytest.raises(
        GeometryError, match=r"^wipers: left and right come within 0\.1013 m of each other at crank angle 180"
    ):
        check_clearance(left, right, 0.29)
