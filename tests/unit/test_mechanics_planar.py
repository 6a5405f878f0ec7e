"""The planar core: assembly, Jacobian, and what the solver does when it cannot succeed."""

import math

import numpy as np
import pytest

from hilplant.mechanics.newton_raphson import SolutionError, follow, positions, rates
from hilplant.mechanics.planar import Body, Driving, Ground, Mechanism, Point, Revolute, Rigid


def four_bar(a: Point, b: Point, c: Point) -> Mechanism:
    """Return a crank from the origin to `a`, a coupler to `b` and a rocker about `c`."""
    crank, coupler, rocker = (
        Body.between("crank", (0.0, 0.0), a),
        Body.between("coupler", a, b),
        Body.between("rocker", b, c),
    )
    joints = (
        Ground("ground"),
        Revolute(("ground", (0.0, 0.0)), crank.first_end),
        Revolute(crank.second_end, coupler.first_end),
        Revolute(coupler.second_end, rocker.first_end),
        Revolute(rocker.second_end, ("ground", c)),
        Driving("crank"),
    )
    return Mechanism((Body.ground(), crank, coupler, rocker), joints)


@pytest.fixture
def parallelogram() -> Mechanism:
    """Its rocker turns as its crank does; crank angle pi/2 at the design position."""
    return four_bar((0.0, 1.0), (3.0, 1.0), (3.0, 0.0))


def test_jacobian_agrees_with_differences_of_the_constraints(parallelogram: Mechanism) -> None:
    q, drive, step = np.random.default_rng(1).normal(size=12), np.array(0.2), 1e-6
    columns = [
        (parallelogram.constraints(q + side, drive) - parallelogram.constraints(q - side, drive)) / (2.0 * step)
        for side in step * np.eye(12)
    ]
    error = np.abs(parallelogram.jacobian(q) - np.array(columns).T).max()
    print(f"\nJacobian against differences: {error:.1e}")
    assert error < 1e-9


def test_jacobian_of_rigid_joints_agrees_with_differences_too() -> None:
    inner, outer = (
        Body.between("inner", (0.0, 0.0), (1.0, 0.0)),
        Body.between("outer", (1.0, 0.0), (1.5, 0.5)),
    )
    pinned, driven = Revolute(("ground", (0.0, 0.0)), inner.first_end), Driving("inner")
    rigid = Rigid(inner.second_end, outer.first_end, math.pi / 4.0)
    mechanism = Mechanism((Body.ground(), inner, outer), (Ground("ground"), pinned, driven, rigid))
    q, step = np.random.default_rng(2).normal(size=9), 1e-6
    columns = [
        (mechanism.constraints(q + side, np.array(0.0)) - mechanism.constraints(q - side, np.array(0.0))) / (2 * step)
        for side in step * np.eye(9)
    ]
    assert np.abs(mechanism.jacobian(q) - np.array(columns).T).max() < 1e-9


def test_a_stack_of_positions_is_evaluated_as_each_of_them_alone(parallelogram: Mechanism) -> None:
    stack, drives = np.random.default_rng(3).normal(size=(5, 12)), np.linspace(0.0, 1.0, 5)
    for q, drive, constraints, jacobian in zip(
        stack, drives, parallelogram.constraints(stack, drives), parallelogram.jacobian(stack), strict=True
    ):
        assert constraints == pytest.approx(parallelogram.constraints(q, drive), abs=1e-15)
        assert np.array_equal(jacobian, parallelogram.jacobian(q))


def test_rocker_of_a_parallelogram_turns_with_its_crank(parallelogram: Mechanism) -> None:
    crank = np.linspace(math.pi / 2.0, math.pi - 0.3, 20)
    q = follow(parallelogram, crank)
    turned = q[:, parallelogram.angle("rocker")] - parallelogram.design[parallelogram.angle("rocker")]
    assert turned == pytest.approx(crank - crank[0], abs=1e-13)
    assert rates(parallelogram, q)[:, parallelogram.angle("rocker")] == pytest.approx(1.0, abs=1e-12)


def test_a_position_out_of_reach_is_refused_with_numbers() -> None:
    short = four_bar((0.0, 1.0), (2.0, 1.0), (2.5, 0.0))
    with pytest.raises(SolutionError, match=r"^Newton-Raphson has not converged at drive angle 180\.000 deg: .*1e-12$"):
        positions(short, short.design, np.array(math.pi))


def test_coming_to_a_dead_point_is_refused(parallelogram: Mechanism) -> None:
    """Where the links lie in one line the rocker may go on either way; the solver must not choose."""
    with pytest.raises(SolutionError, match=r"^a joint comes to its dead point at drive angle 1(80\.0|79\.9)\d\d deg$"):
        follow(parallelogram, math.pi / 2.0 + np.linspace(0.0, 2.0 * math.pi, 403))


def test_coordinates_left_free_are_refused_at_assembly() -> None:
    with pytest.raises(ValueError, match="4 constraint equations cannot settle 6 coordinates"):
        Mechanism((Body.ground(), Body.between("bar", (0.0, 0.0), (1.0, 0.0))), (Ground("ground"), Driving("bar")))


def test_a_point_in_a_body_s_own_coordinates_is_found_again_in_the_plane() -> None:
    bar, point = Body.between("bar", (1.0, 2.0), (-3.0, 5.0)), (0.7, -0.4)
    mechanism = Mechanism((bar,), (Revolute(bar.first_end, bar.first_end), Driving("bar")))
    assert mechanism.point(mechanism.design, ("bar", bar.local(point))) == pytest.approx(point, abs=1e-15)
    assert mechanism.point(mechanism.design, bar.second_end) == pytest.approx((-3.0, 5.0), abs=1e-15)
