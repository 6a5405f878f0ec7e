"""How linkage, arms and blades come together, and what is refused."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import yaml

from hilplant.mechanics.arms import arm, arm_points
from hilplant.mechanics.blades import blade_bodies, blade_tips, friction_pins
from hilplant.mechanics.coefficients import Aerodynamics, CoefficientError
from hilplant.mechanics.design_points import GeometryError
from hilplant.mechanics.joining import Meeting, Plan, joined
from hilplant.mechanics.masses import MassError, gravity_in_plane, shared_by_length
from hilplant.mechanics.motion import forward_sense, motion
from hilplant.mechanics.newton_raphson import SolutionError, positions
from hilplant.mechanics.slave_driven import slave_driven
from hilplant.mechanics.turn import followed
from hilplant.mechanics.wiper import SideParts, WiperParts, assemble
from hilplant.resources import shipped

MASSES_KG = {"crank": 0.0845, "coupler": 0.3835, "left_rocker": 0.1157, "link": 0.6370, "right_rocker": 0.0780}


@pytest.fixture(scope="module")
def written() -> dict[str, Any]:
    loaded = yaml.safe_load(shipped("config", "linkages", "rhd_slave_driven.yaml").read_text())
    assert isinstance(loaded, dict)
    return loaded


@pytest.fixture(scope="module")
def parts(written: dict[str, Any]) -> WiperParts:
    left, right = (
        SideParts(
            arm_points(written[f"{name}_arm"]["kind"], written[f"{name}_arm"]["points_m"]),
            blade_tips(written[f"{name}_blade"]["points_m"]),
            0.5,
            0.3,
        )
        for name in ("left", "right")
    )
    return WiperParts(slave_driven(written["points_m"]), left, right, masses_kg=MASSES_KG)


def test_arms_and_blades_stand_on_their_design_points_at_park(parts: WiperParts) -> None:
    wiper = assemble(parts)
    coordinates = motion(wiper, np.zeros(1)).coordinates
    for side, pivot, given in zip(
        wiper.sides, (parts.linkage.left_pivot, parts.linkage.right_pivot), (parts.left, parts.right), strict=True
    ):
        rods = [body for body in wiper.bodies if body.name in side.bodies]
        assert len(rods) == len(given.arm) - 1 + 2
        for rod, point in zip(rods, given.arm[1:], strict=False):
            at = wiper.mechanism.point(coordinates, rod.second_end)[0]
            assert at == pytest.approx(np.add(pivot, point), abs=1e-12)
        assert given.blade is not None
        for pin, tip in zip(side.tips, given.blade, strict=True):
            at = wiper.mechanism.point(coordinates, pin)[0]
            assert at == pytest.approx(np.add(np.add(pivot, given.arm[-1]), tip), abs=1e-12)


def test_the_motion_satisfies_all_constraints_of_the_whole_mechanism(parts: WiperParts) -> None:
    """Positions, velocities and accelerations of arms and blades, taken from their rockers, keep every joint."""
    wiper = assemble(parts)
    mechanism, crank_rad = wiper.mechanism, np.linspace(0.0, 6.2, 40)
    moving = motion(wiper, crank_rad)
    jacobian = mechanism.jacobian(moving.coordinates)
    speeds = np.einsum("mij,mj->mi", jacobian, moving.rates) - mechanism.drive
    turning = mechanism.turning(moving.coordinates, moving.rates)
    changes = np.einsum("mij,mj->mi", jacobian, moving.accelerations) - turning
    for left in (mechanism.constraints(moving.coordinates, wiper.park_rad + crank_rad), speeds, changes):
        assert np.abs(left).max() < 1e-12
    alone = positions(mechanism, moving.coordinates + 1e-3, wiper.park_rad + crank_rad)
    assert np.abs(alone - moving.coordinates).max() < 1e-12


def test_the_arm_record_is_that_of_the_bare_linkage(parts: WiperParts) -> None:
    linkage = parts.linkage.mechanism()
    at_park = positions(linkage, linkage.design, np.array(parts.linkage.design_crank_angle_rad))
    for side, given in zip(assemble(parts).sides, (parts.left, parts.right), strict=True):
        rocker_rad = at_park[linkage.angle(f"{side.name}_rocker")]
        assert side.arm == pytest.approx(arm(given.arm, rocker_rad), abs=1e-12)


@pytest.mark.parametrize(
    "kinds", [("straight", "straight"), ("straight", "bent"), ("bent", "straight"), ("bent", "bent")]
)
def test_arms_of_either_kind_sit_on_either_rocker(
    parts: WiperParts, written: dict[str, Any], kinds: tuple[str, str]
) -> None:
    shapes = {written[f"{name}_arm"]["kind"]: written[f"{name}_arm"]["points_m"] for name in ("left", "right")}
    sides = [
        replace(side, arm=arm_points(kind, shapes[kind]))
        for side, kind in zip((parts.left, parts.right), kinds, strict=True)
    ]
    wiper = assemble(replace(parts, left=sides[0], right=sides[1]))
    assert [len(side.bodies) for side in wiper.sides] == [{"straight": 5, "bent": 4}[kind] for kind in kinds]
    moving = motion(wiper, np.linspace(0.0, 6.0, 9))
    for side in wiper.sides:
        joint, pivot = (wiper.mechanism.point(moving.coordinates, pin) for pin in (side.centre, side.pivot))
        assert np.linalg.norm(joint - pivot, axis=1) == pytest.approx(side.arm.length_m, abs=1e-12)
    assert wiper.masses_kg.sum() == pytest.approx(sum(MASSES_KG.values()) + 1.6)


def test_one_friction_point_is_the_joint_and_more_are_spread_from_tip_to_tip() -> None:
    bodies = blade_bodies("left", (1.0, 2.0), ((0.3, 0.0), (-0.5, 0.0)))
    assert friction_pins(bodies, 1) == (bodies[0].first_end,)
    places = [
        (bodies[0] if name == "left_blade_a" else bodies[1]).origin_m[0] + (1 if name == "left_blade_a" else -1) * x
        for name, (x, _) in friction_pins(bodies, 4)
    ]
    assert places == pytest.approx([1.2, 1.0, 0.8, 0.6])


def test_a_blade_is_two_rods_with_the_mass_and_inertia_of_one() -> None:
    """A straight blade held anywhere: rods O-A and O-B together are a rod from tip to tip."""
    bodies = blade_bodies("left", (0.0, 0.0), ((0.6, 0.0), (-0.4, 0.0)))
    masses = shared_by_length(bodies, 0.3)
    assert list(masses.values()) == pytest.approx([0.18, 0.12])
    about_joint = sum(
        masses[body.name] * (body.length_m**2 / 12.0 + math.hypot(*body.origin_m) ** 2) for body in bodies
    )
    assert about_joint == pytest.approx(0.3 * (1.0 / 12.0 + 0.1**2))


def test_gravity_in_the_plane_is_that_of_the_thesis() -> None:
    assert gravity_in_plane(math.radians(-30.0)) == pytest.approx(8.496, abs=5e-4)  # (4.48)
    assert gravity_in_plane(0.0) == 9.81
    assert gravity_in_plane(1.5708) == pytest.approx(0.0, abs=1e-4)


def test_forward_is_the_way_up_from_park(parts: WiperParts) -> None:
    assert [forward_sense(assemble(parts), side) for side in assemble(parts).sides] == [-1.0, -1.0]


def test_a_crank_angle_may_be_any_number_of_turns_away(parts: WiperParts) -> None:
    wiper = assemble(parts)
    near, far = (motion(wiper, np.array([0.7, 3.0]) + turns * 2.0 * math.pi) for turns in (0, -3))
    assert np.abs(near.coordinates - far.coordinates).max() < 1e-12


def test_a_bare_arm_stands_for_the_points_of_its_blade(parts: WiperParts) -> None:
    bare = replace(parts.left, blade=None, blade_mass_kg=0.0)
    wiper = assemble(replace(parts, left=bare, points=3))
    assert wiper.left.friction == (wiper.left.centre,) * 3
    assert wiper.left.tips == ()
    with pytest.raises(MassError, match=r"left blade: has a mass of 0\.3 kg, but no points"):
        assemble(replace(parts, left=replace(parts.left, blade=None)))


def test_masses_are_all_given_or_none_and_never_negative(parts: WiperParts) -> None:
    assert assemble(replace(parts, masses_kg={})).masses_kg.sum() == pytest.approx(1.6)
    missing = {name: mass for name, mass in MASSES_KG.items() if name != "link"}
    with pytest.raises(MassError, match="needs crank, coupler, left_rocker, link, right_rocker, has crank"):
        assemble(replace(parts, masses_kg=missing))
    with pytest.raises(MassError, match=r"masses_kg: link: a mass is a number of at least 0 kg, not -0\.1"):
        assemble(replace(parts, masses_kg=MASSES_KG | {"link": -0.1}))
    with pytest.raises(MassError, match="right arm: mass_kg"):
        assemble(replace(parts, right=replace(parts.right, arm_mass_kg=math.nan)))


def test_a_screen_beyond_lying_flat_is_refused(parts: WiperParts) -> None:
    with pytest.raises(MassError, match=r"within a quarter turn, not -33\.0 rad"):
        assemble(replace(parts, screen_angle_rad=-33.0))


def test_no_friction_point_at_all_is_refused(parts: WiperParts) -> None:
    with pytest.raises(GeometryError, match="at least 1 point"):
        assemble(replace(parts, points=0))


def test_air_without_density_is_refused(parts: WiperParts) -> None:
    with pytest.raises(CoefficientError, match="air density: must be above 0 kg/m3, not nan"):
        assemble(replace(parts, air_density_kg_m3=math.nan))


def test_a_linkage_body_with_the_name_of_an_arm_is_refused(parts: WiperParts) -> None:
    plan = {"O": (0.0, 0.0)} | dict(parts.linkage.points)
    bodies = {"crank": "OA", "coupler": "AB", "left_rocker": "BCD", "left_arm_1": "DE", "right_rocker": "EF"}
    order = [("O", "ground", "crank"), ("A", "crank", "coupler"), ("B", "coupler", "left_rocker")]
    order += [("C", "left_rocker", "ground"), ("D", "left_rocker", "left_arm_1")]
    order += [("E", "left_arm_1", "right_rocker"), ("F", "right_rocker", "ground")]
    linkage = joined(Plan("named", plan, bodies, [Meeting(*names) for names in order], ("C", "F")))
    with pytest.raises(GeometryError, match="the name left_arm_1 of a body is that of an arm's or blade's"):
        assemble(replace(parts, linkage=linkage, masses_kg={}))


def test_a_blade_without_length_is_refused() -> None:
    with pytest.raises(GeometryError, match="O and A are one point"):
        blade_tips({"O": [0.0, 0.0], "A": [0.0, 0.0], "B": [-0.5, 0.0]})


@pytest.mark.parametrize(
    ("air", "message"),
    [
        (Aerodynamics(-1.0), "left blade: area_m2 must be a number of at least 0"),
        (Aerodynamics(1.0, math.inf), "left blade: drag must be a finite number"),
        (Aerodynamics(1.0, 0.1, [(1.0, 2.0)]), "left blade: lift must be a number or at least two pairs"),
        (Aerodynamics(1.0, 0.1, [(1.0, 2.0), (1.0, 3.0)]), "left blade: lift: the arm's angles must rise, but 1.0"),
    ],
)
def test_areas_and_coefficients_that_mean_nothing_are_refused(
    parts: WiperParts, air: Aerodynamics, message: str
) -> None:
    with pytest.raises(CoefficientError, match=message):
        assemble(replace(parts, left=replace(parts.left, air=air)))


def test_a_rocker_that_goes_round_is_refused(parts: WiperParts) -> None:
    """The crank itself, called a rocker, is a turn away after a turn."""
    linkage = parts.linkage
    with pytest.raises(SolutionError, match=r"the body crank is 6\.28 rad away from where it began"):
        followed(linkage.mechanism(), linkage.design_crank_angle_rad, ("crank",))
