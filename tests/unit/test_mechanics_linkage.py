"""Which linkages are accepted, and what is said of those that are not."""

import math

import numpy as np
import pytest
import yaml

from hilplant.mechanics.design_points import GeometryError
from hilplant.mechanics.feasibility import dead_centre_angles, reach
from hilplant.mechanics.newton_raphson import follow
from hilplant.mechanics.slave_driven import slave_driven
from hilplant.resources import shipped
from hilplant.units import RAD_PER_DEG, TURN_RAD

Written = dict[str, list[float]]


@pytest.fixture
def points() -> Written:
    written = yaml.safe_load(shipped("config", "linkages", "rhd_slave_driven.yaml").read_text())
    return dict(written["points_m"])


def refusal(points: Written) -> str:
    with pytest.raises(GeometryError) as caught:
        slave_driven(points)
    text = str(caught.value)
    assert "\n" not in text
    return text


def test_the_shipped_linkage_is_accepted(points: Written) -> None:
    linkage = slave_driven(points)
    assert linkage.design_crank_angle_rad / RAD_PER_DEG == pytest.approx(7.0458, abs=1e-4)


def test_a_crank_too_long_for_grashof_is_refused_with_the_lengths(points: Written) -> None:
    text = refusal(points | {"A": [0.066, 0.008]})
    assert text.startswith("linkage: the crank OA cannot turn fully: OA + AB = 0.358 m must be less than ")
    assert text.endswith("BC + OC = 0.3418 m (Grashof): shorten OA below 0.05026 m")


def test_a_crank_that_is_not_the_shortest_link_is_refused(points: Written) -> None:
    assert "the crank OA (0.1 m) must be the shortest of OC, OA, AB, BC" in refusal(points | {"A": [0.1, 0.0]})


def test_a_change_point_is_refused() -> None:
    square: Written = {
        "O": [0, 0],
        "A": [1, 0],
        "B": [1, 2],
        "C": [0, 2],
        "D": [0.5, 2],
        "E": [5, 2],
        "F": [5, 0],
    }
    assert "OA + AB = 3 m must be less than BC + OC = 3 m (Grashof)" in refusal(square)


def test_a_link_too_short_for_the_right_rocker_is_refused_with_the_reach(points: Written) -> None:
    text = refusal(points | {"E": [0.2030, 0.0005]})
    assert text.startswith("linkage: the rocker EF cannot follow: D and F are up to 0.5092 m apart")
    assert "must be less than DE + EF = 0.46" in text
    assert text.endswith(": no DE would do, first make EF longer than 0.03502 m")


def test_a_right_rocker_that_keeps_d_and_f_too_far_apart_is_refused(points: Written) -> None:
    """Written down at half of the sweep, with E behind F seen from D: nearer than there D and F cannot come."""
    linkage = slave_driven(points)
    mechanism = linkage.mechanism()
    half = follow(mechanism, linkage.design_crank_angle_rad + np.linspace(0.0, math.pi / 2.0, 9))[-1]
    pins = {"A": mechanism.point(half, linkage.body("crank").second_end)}
    pins["B"], pins["D"] = (mechanism.point(half, linkage.body(body).first_end) for body in ("left_rocker", "link"))
    to_f = np.array(points["F"][:2]) - pins["D"]
    pins["E"] = np.array(points["F"][:2]) + 0.1 * to_f / np.hypot(*to_f)
    text = refusal(points | {name: list(at) for name, at in pins.items()})
    assert "D and F come as near as 0.4392 m" in text
    assert f"which must be more than |DE - EF| = {np.hypot(*to_f):.4g} m: DE between " in text


def test_points_on_one_another_are_refused(points: Written) -> None:
    assert refusal(points | {"B": points["A"]}) == "linkage: A and B are one point, AB needs a length"


def test_a_missing_point_and_a_wrong_one_are_named(points: Written) -> None:
    short = {name: at for name, at in points.items() if name != "E"}
    assert refusal(short) == "linkage: needs the points O, A, B, C, D, E, F, has O, A, B, C, D, F"
    assert refusal(points | {"D": [0.1, math.nan]}).startswith("linkage: point D must be [x, y] or [x, y, z]")
    assert refusal(points | {"D": [0.1]}).startswith("linkage: point D must be [x, y] or [x, y, z]")


def test_the_third_coordinate_is_left_out(points: Written) -> None:
    flat = {name: at[:2] for name, at in points.items()}
    leaning = {name: [*at[:2], 0.1 * index] for index, (name, at) in enumerate(points.items())}
    assert slave_driven(flat) == slave_driven(leaning)


def test_reach_agrees_with_the_thesis_sweep_of_the_crank(points: Written) -> None:
    """(4.27)-(4.32) swept finely, angles from lengths; only C and O are placed by the design."""
    at = {name: np.array(point[:2]) for name, point in points.items()}
    l1, l2, l3, l4 = (float(np.hypot(*(at[q] - at[p]))) for p, q in ("OC", "OA", "AB", "BC"))
    l5, l8 = (float(np.hypot(*(at[q] - at[p]))) for p, q in ("CD", "FC"))
    theta_1 = np.linspace(0.0, TURN_RAD, 200_001)
    ac = np.sqrt(l1**2 + l2**2 - 2.0 * l1 * l2 * np.cos(theta_1))
    cosines = (l1**2 + ac**2 - l2**2) / (2.0 * l1 * ac), (l4**2 + ac**2 - l3**2) / (2.0 * l4 * ac)
    aco, acb = (np.arccos(np.clip(cosine, -1.0, 1.0)) for cosine in cosines)
    ocb = np.where(theta_1 <= math.pi, acb - aco, acb + aco)
    placed = {name: (point[0], point[1]) for name, point in points.items()}
    assert dead_centre_angles(placed) == pytest.approx((ocb.min(), ocb.max()), abs=1e-9)
    # In this linkage B lies clockwise of CO, and D on CB; F is to the right of C at the same height.
    theta_3 = math.atan2(*(at["O"] - at["C"])[::-1]) - ocb
    fd = np.sqrt(l5**2 + l8**2 - 2.0 * l5 * l8 * np.cos(theta_3))
    assert reach(placed) == pytest.approx((fd.min(), fd.max()), abs=2e-5)  # D is 0.02 mm off the line CB


def test_reach_sees_d_pass_between_c_and_f_within_the_sweep(points: Written) -> None:
    placed = {name: (point[0], point[1]) for name, point in points.items()} | {"F": (-0.272, -0.5)}
    assert reach(placed)[0] == pytest.approx(0.527 - math.dist(placed["C"], placed["D"]), abs=1e-12)


def test_a_bent_rocker_keeps_its_own_shape(points: Written) -> None:
    linkage = slave_driven(points | {"D": [-0.240, -0.012]})
    mechanism = linkage.mechanism()
    assert np.abs(mechanism.constraints(mechanism.design, np.array(linkage.design_crank_angle_rad))).max() < 1e-15


def test_the_design_position_itself_is_solved_but_for_the_rounding_of_its_points(points: Written) -> None:
    linkage = slave_driven(points)
    mechanism = linkage.mechanism()
    residual = np.abs(mechanism.constraints(mechanism.design, np.array(linkage.design_crank_angle_rad))).max()
    print(f"\nD is {1e6 * residual:.1f} um off the line that (4.10) puts it on")
    assert 1e-5 < residual < 2e-5
