"""The arms: what the step needs of them, and their bodies joined rigidly."""

import math

import numpy as np
import pytest
import yaml

from hilplant.mechanics.arms import arm, arm_mechanism, arm_points
from hilplant.mechanics.design_points import GeometryError
from hilplant.mechanics.linkage import SlaveDrivenLinkage, rocker_tables
from hilplant.mechanics.newton_raphson import positions
from hilplant.resources import shipped
from hilplant.units import RAD_PER_DEG

FILE = yaml.safe_load(shipped("config", "linkages", "rhd_slave_driven.yaml").read_text())
ARMS = ("left_arm", "right_arm")


@pytest.mark.parametrize("name", ARMS)
def test_the_blade_s_joint_goes_where_the_rigid_bodies_carry_it(name: str) -> None:
    points = arm_points(FILE[name]["kind"], FILE[name]["points_m"])
    record = arm(points, 0.0)
    mechanism = arm_mechanism(points)
    last, length = list(mechanism.bodies)[-1], math.dist(points[-2], points[-1])
    to_blade = math.atan2(points[-1][1], points[-1][0]) - record.offset_rad
    for turned in np.linspace(-1.5, 1.5, 7):
        q = positions(mechanism, mechanism.design, np.array(record.offset_rad + turned))
        angle = record.offset_rad + turned + to_blade
        expected = record.length_m * math.cos(angle), record.length_m * math.sin(angle)
        assert mechanism.point(q, (last, (length / 2.0, 0.0))) == pytest.approx(expected, abs=1e-14)


def test_arms_have_the_lengths_and_angles_of_their_points() -> None:
    left = arm(arm_points("straight", FILE["left_arm"]["points_m"]), 2.0)
    right = arm(arm_points("bent", FILE["right_arm"]["points_m"]), 2.0)
    assert left == pytest.approx((math.atan2(0.01, -0.57) - 2.0, math.hypot(0.69, 0.05)))
    assert right == pytest.approx((math.atan2(0.1, -0.3) - 2.0, math.hypot(0.5, 0.2)))


@pytest.mark.parametrize(
    ("rocker", "name", "park", "top"), [(0, "left_arm", 178.995, 97.119), (1, "right_arm", 161.565, 78.783)]
)
def test_parked_arms_lie_at_the_bottom_and_rise_clockwise(
    rocker: int, name: str, park: float, top: float
) -> None:
    table = rocker_tables(SlaveDrivenLinkage.from_points(FILE["points_m"]))[rocker]
    points = arm_points(FILE[name]["kind"], FILE[name]["points_m"])
    record = arm(points, table[0, 0])
    angles = table[:, 0] + record.offset_rad
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
