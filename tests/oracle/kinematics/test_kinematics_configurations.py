"""The six shipped linkages over a full turn against circles that meet, and their velocities and accelerations."""

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import yaml

from hilplant.mechanics.linkage import Linkage
from hilplant.mechanics.newton_raphson import accelerations, follow, positions, rates
from hilplant.mechanics.transmission import check_transmission
from hilplant.resources import shipped
from hilplant.units import RAD_PER_DEG, TURN_RAD

CRANK = np.linspace(0.0, TURN_RAD, 1025)


def near_and_far(linkage: Linkage, placed: dict[str, complex]) -> list[str]:
    """Return the rockers' names in the order of the closed form: about C first."""
    pivot = complex(*linkage.left_pivot)
    return ["left_rocker", "right_rocker"] if pivot == placed["C"] else ["right_rocker", "left_rocker"]


def test_every_configuration_agrees_with_circles_that_meet(
    linkage: Linkage, placed: dict[str, complex], circles: Callable[..., Any]
) -> None:
    mechanism = linkage.mechanism()
    solved = follow(mechanism, linkage.design_crank_angle_rad + CRANK)
    truth = np.unwrap(circles(linkage.kind, placed, CRANK).angles)
    for angles, name in zip(truth, near_and_far(linkage, placed), strict=True):
        error = np.abs(solved[:, mechanism.angle(name)] - angles).max()
        sweep = np.ptp(angles) / RAD_PER_DEG
        print(f"\n{linkage.kind} {name}: sweep {sweep:.3f} deg, error {error:.1e} rad, limit 1e-10")
        assert error < 1e-10
        assert 60.0 < sweep < 110.0
        assert solved[-1, mechanism.angle(name)] == pytest.approx(angles[0], abs=1e-12)


def test_every_configuration_s_velocities_and_accelerations_agree_with_differences_of_the_circles(
    linkage: Linkage, placed: dict[str, complex], circles: Callable[..., Any]
) -> None:
    mechanism, step = linkage.mechanism(), 1e-3
    solved = follow(mechanism, linkage.design_crank_angle_rad + CRANK)
    first, second = rates(mechanism, solved), accelerations(mechanism, solved)
    around = np.stack(
        [circles(linkage.kind, placed, CRANK + shift * step).angles for shift in (-3, -2, -1, 0, 1, 2, 3)]
    )
    around = np.unwrap(around, axis=0)
    velocity = np.tensordot([-1, 9, -45, 0, 45, -9, 1], around, axes=1) / (60.0 * step)
    acceleration = np.tensordot([2, -27, 270, -490, 270, -27, 2], around, axes=1) / (180.0 * step**2)
    for at, name in enumerate(near_and_far(linkage, placed)):
        errors = [
            np.abs(ours[:, mechanism.angle(name)] - truth[at]).max()
            for ours, truth in ((first, velocity), (second, acceleration))
        ]
        print(f"\n{linkage.kind} {name}: velocity {errors[0]:.1e}, acceleration {errors[1]:.1e} off the differences")
        assert errors[0] < 1e-10
        assert errors[1] < 1e-7


def test_velocities_and_accelerations_agree_with_a_complex_step_through_the_solver(linkage: Linkage) -> None:
    """The solver itself in complex numbers, its drive moved by i h: no difference is taken, so no digit is lost."""
    mechanism, h = linkage.mechanism(), 1e-25
    drive = linkage.design_crank_angle_rad + np.linspace(0.0, TURN_RAD, 65)
    solved = follow(mechanism, drive)
    stepped = solved + 0j
    for _ in range(3):
        residual = mechanism.constraints(stepped, drive + 1j * h)
        stepped = stepped - np.linalg.solve(mechanism.jacobian(stepped), residual[..., np.newaxis])[..., 0]
    velocity, acceleration = stepped.imag / h, rates(mechanism, stepped).imag / h
    assert np.abs(rates(mechanism, solved) - velocity).max() < 1e-12
    assert np.abs(accelerations(mechanism, solved) - acceleration).max() < 1e-12


def test_accelerations_of_a_crank_that_speeds_up_follow_from_both_derivatives(linkage: Linkage) -> None:
    mechanism = linkage.mechanism()
    solved = follow(mechanism, linkage.design_crank_angle_rad + np.linspace(0.0, TURN_RAD, 65))
    speed, acceleration, step = 3.0, -20.0, 1e-4
    drive = solved[:, mechanism.angle(linkage.crank)]
    ahead, behind = (
        positions(mechanism, solved, drive + speed * time + acceleration * time**2 / 2.0) for time in (step, -step)
    )
    difference = (ahead - 2.0 * solved + behind) / step**2
    error = np.abs(accelerations(mechanism, solved, speed, acceleration) - difference).max()
    print(f"\naccelerations against differences over time: {error:.1e} of {np.abs(difference).max():.0f} rad/s2")
    assert error < 2e-5


def test_jacobians_agree_with_differences_and_a_complex_step(linkage: Linkage) -> None:
    mechanism = linkage.mechanism()
    random = np.random.default_rng(1)
    q, drive, unit = random.normal(size=18), np.array(0.2), np.eye(18)
    exact = np.array([mechanism.constraints(q + 1e-30j * side, drive).imag / 1e-30 for side in unit]).T
    difference = [
        (mechanism.constraints(q + 1e-6 * side, drive) - mechanism.constraints(q - 1e-6 * side, drive)) / 2e-6
        for side in unit
    ]
    assert np.abs(mechanism.jacobian(q) - exact).max() < 1e-15
    assert np.abs(mechanism.jacobian(q) - np.array(difference).T).max() < 1e-9


def test_both_arms_of_every_configuration_rise_together_from_the_lower_end(
    linkage: Linkage, written: dict[str, Any]
) -> None:
    """With the wheel on the right they rise clockwise, with the wheel on the left the other way."""
    mechanism = linkage.mechanism()
    solved = follow(mechanism, linkage.design_crank_angle_rad + CRANK)
    hand = 1.0 if written["name"].startswith("RHD") else -1.0
    for rocker in ("left_rocker", "right_rocker"):
        angle = hand * solved[:, mechanism.angle(rocker)]
        assert angle.max() - angle[0] < 0.02 * RAD_PER_DEG
        assert 0.49 < np.abs(CRANK[angle.argmin()] - CRANK[0]) / TURN_RAD < 0.51


@pytest.mark.parametrize("kind", ["slave_driven", "master_driven", "centre_driven"])
def test_left_hand_drive_is_the_mirror_image_of_right_hand_drive(kind: str) -> None:
    right, left = (
        yaml.safe_load(shipped("config", "linkages", f"{hand}_{kind}.yaml").read_text()) for hand in ("rhd", "lhd")
    )
    pairs = [("points_m", "points_m")]
    pairs += [(f"{side}_{part}", f"{other}_{part}") for part in ("arm", "blade") for side, other in (_LR, _LR[::-1])]
    for ours, theirs in pairs:
        assert json.dumps(_mirrored(right[ours])) == json.dumps(_plain(left[theirs]))


_LR = ("left", "right")


def _plain(section: dict[str, Any]) -> dict[str, Any]:
    points = section.get("points_m", section)
    kind = {"kind": section["kind"]} if "kind" in section else {}
    return kind | {name: [float(value) + 0.0 for value in at] for name, at in points.items()}


def _mirrored(section: dict[str, Any]) -> dict[str, Any]:
    plain = _plain(section)
    return {name: at if isinstance(at, str) else [-at[0] + 0.0, *at[1:]] for name, at in plain.items()}


def test_every_configuration_keeps_well_away_from_its_dead_points(
    linkage: Linkage, placed: dict[str, complex], circles: Callable[..., Any]
) -> None:
    """The transmission angle by the cosine rule, at the distances of the circles' centres."""
    closest = check_transmission(linkage, 35.0)
    angles = []
    for distance, difference, total in circles(linkage.kind, placed, CRANK).gaps:
        first, second = (total + difference) / 2.0, (total - difference) / 2.0
        angles.append(np.arccos((first**2 + second**2 - distance**2) / (2.0 * first * second)).ravel())
    truth = min(np.minimum(angle, np.pi - angle).min() for angle in angles)
    print(f"\n{linkage.kind}: {closest.transmission_angle_rad / RAD_PER_DEG:.3f} deg at {closest.where}")
    assert closest.transmission_angle_rad == pytest.approx(truth, abs=1e-10)
