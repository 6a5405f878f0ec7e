"""The arms: what the step needs of them."""

import math

import numpy as np
import pytest
import yaml

from hilplant.mechanics.arms import arm, arm_points
from hilplant.mechanics.design_points import GeometryError
from hilplant.mechanics.slave_driven import slave_driven
from hilplant.mechanics.transmission import followed_turn
from hilplant.resources import shipped
from hilplant.units import RAD_PER_DEG

FILE = yaml.safe_load(shipped("config", "linkages", "rhd_slave_driven.yaml").read_text())


def test_arms_have_the_lengths_and_angles_of_their_points() -> None:
    left = arm(arm_points("straight", FILE["left_arm"]["points_m"]), 2.0)
    right = arm(arm_points("bent", FILE["right_arm"]["points_m"]), 2.0)
    assert left == pytest.approx((math.atan2(0.01, -0.57) - 2.0, math.hypot(0.69, 0.05)))
    assert right == pytest.approx((math.atan2(0.1, -0.3) - 2.0, math.hypot(0.5, 0.2)))


@pytest.mark.parametrize(
    ("rocker", "name", "park", "top"), [(0, "left_arm", 178.995, 97.119), (1, "right_arm", 161.565, 78.783)]
)
def test_parked_arms_lie_at_the_bottom_and_rise_clockwise(rocker: int, name: str, park: float, top: float) -> None:
    mechanism, coordinates = followed_turn(slave_driven(FILE["points_m"]))
    turned = coordinates[:, mechanism.angle(("left_rocker", "right_rocker")[rocker])]
    points = arm_points(FILE[name]["kind"], FILE[name]["points_m"])
    record = arm(points, turned[0])
    angles = turned + record.offset_rad
    to_blade = math.atan2(points[-1][1], points[-1][0]) - math.atan2(points[1][1], points[1][0])
    heights = record.length_m * np.sin(angles + to_blade)
    print(f"\n{name}: park {angles[0] / RAD_PER_DEG:.3f}, top {angles.min() / RAD_PER_DEG:.3f} deg; ", end="")
    print(f"blade joint {heights[0]:.4f} m up at park, at most {heights.max():.4f} m")
    assert angles[0] / RAD_PER_DEG == pytest.approx(park, abs=1e-3)
    assert angles.min() / RAD_PER_DEG == pytest.approx(top, abs=1e-3)
    assert heights[0] - heights.min() < 2e-4
    assert heights.max() - heights[0] > 0.3


def test_an_arm_with_a_missing_point_is_refused() -> None:
    with pytest.raises(GeometryError, match="straight arm: needs the points O, A, B, C, has O, A, B"):
        arm_points("straight", FILE["right_arm"]["points_m"])


def test_an_arm_whose_blade_sits_on_its_pivot_is_refused() -> None:
    with pytest.raises(GeometryError, match="bent arm: O and B are one point, OB needs a length"):
        arm_points("bent", {"O": [0.0, 0.0], "A": [1.0, 0.0], "B": [0.0, 0.0]})
