"""The rockers' tables against a closed form: two circles meet in the joint that two links share.

The closed form knows nothing of coordinates, constraints or iterations. It takes the linkage as (4.10) draws
it, with C, D and B in one line.
"""

from collections.abc import Callable

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray

from hilplant.arrays import Floats
from hilplant.mechanics.design_points import GeometryError
from hilplant.mechanics.linkage import Linkage
from hilplant.mechanics.newton_raphson import follow, positions, rates
from hilplant.mechanics.slave_driven import slave_driven
from hilplant.mechanics.tables import run_time_table
from hilplant.mechanics.wiper import WiperParts, assemble
from hilplant.models.lookup import find, value
from hilplant.resources import shipped
from hilplant.units import RAD_PER_DEG, TURN_RAD

Complexes = NDArray[np.complex128]
KNOTS = 1024
#: Published or found before: sweep of the rocker [deg], largest |d rocker / d crank|.
KNOWN = {"left": ("81.889", "0.6999"), "right": ("82.794", "0.7288")}


@pytest.fixture(scope="module")
def points() -> dict[str, list[float]]:
    written = yaml.safe_load(shipped("config", "linkages", "rhd_slave_driven.yaml").read_text())
    return dict(written["points_m"])


@pytest.fixture(scope="module")
def linkage(points: dict[str, list[float]]) -> Linkage:
    return slave_driven(points)


@pytest.fixture(scope="module")
def tables(shipped_parts: Callable[[str], WiperParts]) -> Floats:
    """Return the table that the step reads, with its channels first."""
    table = run_time_table(assemble(shipped_parts("rhd_slave_driven")), KNOTS)
    return np.ascontiguousarray(table[:, :2].transpose(1, 0, 2))


def closed_form(points: dict[str, list[float]], crank_rad: Floats) -> Floats:
    """Return the angles of B to C and of E to F [2, m] over crank angles from the design position."""
    o, a, b, c, d, e, f = (complex(*points[name][:2]) for name in "OABCDEF")
    along = abs(d - c) * (b - c) / abs(b - c)
    a_turned = o + (a - o) * np.exp(1j * crank_rad)
    b_turned = _meeting(a_turned, abs(b - a), c, abs(b - c), _side(a, b, c))
    d_turned = c + along * (b_turned - c) / (b - c)
    e_turned = _meeting(d_turned, abs(e - d), f, abs(e - f), _side(d, e, f))
    return np.unwrap(np.angle(np.stack([c - b_turned, f - e_turned])))


def _meeting(first: Complexes, radius: float, second: complex, other_radius: float, side: float) -> Complexes:
    distance = np.abs(second - first)
    along = (distance**2 + radius**2 - other_radius**2) / (2.0 * distance)
    across = side * np.sqrt(radius**2 - along**2)
    return np.asarray(first + (second - first) / distance * (along + 1j * across))


def _side(first: complex, joint: complex, second: complex) -> float:
    return float(np.sign(((second - first).conjugate() * (joint - first)).imag))


def looked_up(tables: Floats, crank_rad: Floats) -> Floats:
    """Return the angles that the step reads out of the rockers' channels [2, m]."""
    table = np.ascontiguousarray(tables.transpose(1, 0, 2))
    return np.array([[value(table, find(table, angle), rocker) for angle in crank_rad] for rocker in range(2)])


def test_knots_agree_with_the_closed_form(points: dict[str, list[float]], tables: Floats) -> None:
    truth = closed_form(points, np.linspace(0.0, TURN_RAD, KNOTS + 1))
    error = np.abs(tables[..., 0] - truth).max()
    print(f"\nknots against the closed form: {error:.1e} rad")
    assert error < 1e-12


def test_between_the_knots_the_tables_agree_with_newton_raphson_and_the_closed_form(
    points: dict[str, list[float]], linkage: Linkage, tables: Floats
) -> None:
    crank = np.sort(np.random.default_rng(1).uniform(0.0, TURN_RAD, 4000))
    read = looked_up(tables, crank)
    mechanism = linkage.mechanism()
    solved = follow(mechanism, linkage.design_crank_angle_rad + np.concatenate([[0.0], crank]))[1:]
    newton_raphson = solved[:, [mechanism.angle("left_rocker"), mechanism.angle("right_rocker")]].T
    errors = [np.abs(read - truth).max() for truth in (newton_raphson, closed_form(points, crank))]
    print(f"\nbetween knots against Newton-Raphson {errors[0]:.1e}, closed form {errors[1]:.1e}, limit 1e-6 rad")
    assert max(errors) < 1e-10


@pytest.mark.parametrize(("rocker", "name"), [(0, "left"), (1, "right")])
def test_sweep_and_steepest_ratio_have_the_known_digits(tables: Floats, rocker: int, name: str) -> None:
    angles = looked_up(tables, np.linspace(0.0, TURN_RAD, 20_000))[rocker]
    sweep = f"{np.ptp(angles) / RAD_PER_DEG:.3f}"
    steepest = f"{np.abs(tables[rocker, :, 1]).max():.4f}"
    print(f"\n{name} rocker: sweep known {KNOWN[name][0]} ours {sweep} deg; ", end="")
    print(f"peak ratio known {KNOWN[name][1]} ours {steepest}")
    assert (sweep, steepest) == KNOWN[name]


def test_derivatives_agree_with_differences_of_the_closed_form(points: dict[str, list[float]], tables: Floats) -> None:
    crank, step = np.linspace(0.0, TURN_RAD, KNOTS + 1), 1e-5
    difference = (closed_form(points, crank + step) - closed_form(points, crank - step)) / (2.0 * step)
    error = np.abs(tables[..., 1] - difference).max()
    print(f"\nderivatives at the knots against differences of the closed form: {error:.1e}")
    assert error < 1e-8


def test_tables_close_exactly_and_without_jumps(tables: Floats) -> None:
    assert tables.shape == (2, KNOTS + 1, 2)
    assert np.array_equal(tables[:, -1], tables[:, 0])
    assert np.abs(np.diff(tables[..., 0])).max() < 0.73 * TURN_RAD / KNOTS


def test_crank_angle_zero_is_the_low_end_of_the_sweep(tables: Floats) -> None:
    crank = np.linspace(0.0, TURN_RAD, 36_001)
    for angles in looked_up(tables, crank):
        lowest, highest = crank[angles.argmax()] / RAD_PER_DEG, crank[angles.argmin()] / RAD_PER_DEG
        print(f"\nlowest at {lowest:.3f}, highest at {highest:.3f} deg of crank; ", end="")
        print(f"park is {(angles.max() - angles[0]) / RAD_PER_DEG:.4f} deg above the lowest")
        assert lowest == pytest.approx(358.510, abs=6e-3)
        assert highest == pytest.approx(177.952, abs=6e-3)
        assert angles.max() - angles[0] < 0.015 * RAD_PER_DEG


def test_linkages_of_random_proportions_agree_with_the_closed_form_or_are_refused(
    points: dict[str, list[float]],
) -> None:
    random, agreed = np.random.default_rng(3), 0
    crank = np.linspace(0.0, TURN_RAD, 129)
    for _ in range(60):
        shaken = {name: list(np.array(at[:2]) + random.normal(0.0, 0.012, 2)) for name, at in points.items()}
        try:
            linkage = slave_driven(_straightened(shaken))
        except GeometryError:
            assert _cannot_turn(closed_form, _straightened(shaken))
            continue
        mechanism = linkage.mechanism()
        solved = follow(mechanism, linkage.design_crank_angle_rad + crank)
        rockers = solved[:, [mechanism.angle("left_rocker"), mechanism.angle("right_rocker")]].T
        assert np.abs(rockers - closed_form(_straightened(shaken), crank)).max() < 1e-9
        agreed += 1
    print(f"\n{agreed} of 60 random linkages turn")
    assert 10 < agreed < 60


def _straightened(points: dict[str, list[float]]) -> dict[str, list[float]]:
    c, b = np.array(points["C"]), np.array(points["B"])
    return points | {"D": list(c + 0.78 * (b - c))}


def _cannot_turn(solve: Callable[..., Floats], points: dict[str, list[float]]) -> bool:
    """Say whether the circles miss each other somewhere, or the rocker goes round with the crank."""
    with np.errstate(invalid="ignore"):
        angles = solve(points, np.linspace(0.0, TURN_RAD, 20_001))
    return bool(np.isnan(angles).any() or np.abs(angles[0, -1] - angles[0, 0]) > 1.0)


def test_a_position_does_not_depend_on_the_way_there(linkage: Linkage) -> None:
    mechanism = linkage.mechanism()
    crank = linkage.design_crank_angle_rad + np.linspace(0.0, TURN_RAD, 301)
    there, back = follow(mechanism, crank), follow(mechanism, 2.0 * crank[0] - crank)[::-1]
    turned = mechanism.bodies["crank"] * 3 + 2
    expected = np.zeros(18)
    expected[turned] = TURN_RAD
    assert np.abs(there - back - expected).max() < 1e-12


def test_velocities_agree_with_differences_of_positions(linkage: Linkage) -> None:
    mechanism, step = linkage.mechanism(), 1e-5
    crank = linkage.design_crank_angle_rad + np.linspace(0.0, TURN_RAD, 33)
    q = follow(mechanism, crank)
    ahead, behind = (positions(mechanism, q, crank + side) for side in (step, -step))
    error = np.abs(rates(mechanism, q) - (ahead - behind) / (2.0 * step)).max()
    print(f"\nvelocity (4.17) against differences: {error:.1e}")
    assert error < 1e-9
