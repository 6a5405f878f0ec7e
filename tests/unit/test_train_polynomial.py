"""The fit of (6.1)-(6.3): it gives the published polynomials back, its cost is that of the text, its file runs."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hilplant.bench import check_bench, load_bench
from hilplant.models.load import by_speed
from hilplant.models.polynomial import C1, C2, torque_over_speed
from hilplant.models.records import NO_NETWORKS, Load
from hilplant.resources import shipped
from hilplant.signals import Inputs
from hilplant.train.no_load import Polynomials, Shape, content_of, cost, errors, fit, no_load_shape
from hilplant.train.writing import sealed_text
from hilplant.units import TURN_RAD

PUBLISHED = Load(1.0, C1, C2)
FORWARD = (0.68626, 0.077812, -0.15435, 0.021769, -0.19224)
REVERSE = (0.63276, -0.29859, -0.10093, 0.21484, 0.12634, -0.42441, -0.30315, 0.4184)
FREE = Inputs(1.0, 0.0, 13.5, 0.0, 0.0, 0.0)


def published_shape() -> Shape:
    """The torque of the published set: v C2 s(angle) + v^2 C1 C2."""
    angles = np.linspace(0.0, TURN_RAD, 1001, endpoint=False)
    by_speed_alone = np.array([torque_over_speed(angle, 0.0, PUBLISHED, NO_NETWORKS) for angle in angles])
    return Shape(angles, by_speed_alone, np.full(1001, C1 * C2))


def test_the_published_torque_is_fitted_to_its_printed_digits() -> None:
    shape = published_shape()
    found = fit(shape)
    assert cost(shape, found) < 1e-6
    scale = found.c2 / C2  # a factor may pass from the polynomials to C2, and C1 with it
    assert found.forward * scale == pytest.approx(FORWARD, abs=1e-5)
    assert found.reverse * scale == pytest.approx(REVERSE, abs=1e-4)
    assert found.c1 * scale == pytest.approx(C1, abs=1e-6)


def test_the_cost_is_the_sum_of_the_mean_absolute_errors() -> None:
    shape = published_shape()
    constant = Polynomials(np.array([0.5, 0, 0, 0, 0]), np.array([0.5, 0, 0, 0, 0, 0, 0, 0]), 0.0, 1.0)
    by_hand = sum(np.mean(np.abs(v * shape.by_speed + v * v * shape.by_square - 0.5 * v)) for v in (1.0, 3.0))
    assert cost(shape, constant, (1.0, 3.0)) == pytest.approx(by_hand)
    found = errors(shape, constant, (1.0, 3.0))
    assert found["worst_speed_rad_s"] == 3.0 and found["worst_n_m"] >= found["rms_n_m"] >= found["mean_abs_n_m"]


def test_the_constants_cost_no_more_than_any_near_them() -> None:
    shape = no_load_shape(load_bench("linkage_alone").plant.mechanics.wiper)
    found = fit(shape)
    least = cost(shape, found)
    for c1, c2 in ((1e-3, 0.0), (-1e-3, 0.0), (0.0, 1e-3), (0.0, -1e-3), (1e-3, 1e-3), (-1e-3, -1e-3)):
        assert cost(shape, Polynomials(found.forward, found.reverse, found.c1 + c1, found.c2 + c2)) > least


def test_the_torque_of_inertia_is_half_the_change_of_the_kinetic_energy() -> None:
    """By differences of M over the angle, of a wiper whose arms and blades have no mass."""
    wiper = load_bench("default").plant.mechanics.wiper
    shape = no_load_shape(wiper, points=2000)
    total = np.sum(shape.by_square) * TURN_RAD / 2000
    assert abs(total) < 1e-9 and np.ptp(shape.by_square) > 1e-4  # M comes back after a turn
    assert not shape.by_speed.any()
    damped = no_load_shape(replace(wiper, pivot_damping_n_m_s=0.2), points=2000)
    assert damped.by_square == pytest.approx(shape.by_square) and (damped.by_speed >= 0.2).all()


def test_the_file_runs_in_a_bench_and_gives_the_fitted_torque(tmp_path: Path) -> None:
    bench = load_bench("linkage_alone")
    shape = no_load_shape(bench.plant.mechanics.wiper)
    found = fit(shape)
    (tmp_path / "own.yaml").write_text(sealed_text(content_of(bench, shape, found)))
    path = tmp_path / "bench.yaml"
    path.write_text("extends: linkage_alone.yaml\nname: test\nplant:\n  load: {model: polynomial, file: own.yaml}\n")
    parameters = load_bench(path).parameters
    for angle, speed in ((0.3, 2.0), (2.0, 5.0), (4.0, 3.0), (6.0, 6.5)):
        held = by_speed(angle, speed, parameters.load, FREE, parameters.networks)
        assert held.slope * speed == pytest.approx(float(found.torque(np.array([angle]), speed)[0]), rel=1e-12)


def test_the_shipped_polynomial_is_that_of_the_linkage_alone(tmp_path: Path) -> None:
    path = tmp_path / "bench.yaml"
    name = "surrogates/polynomial_linkage_alone.yaml"
    path.write_text(f"extends: linkage_alone.yaml\nname: test\nplant:\n  load: {{model: polynomial, file: {name}}}\n")
    assert check_bench(path) == []
    path.write_text(path.read_text() + "  linkage: linkages/lhd_slave_driven.yaml\n")
    (problem,) = check_bench(path)
    assert "was trained for other parameters" in problem.text
    assert shipped("config", name).is_file()


@pytest.mark.parametrize(
    ("load", "text"),
    [("{model: polynomial}", "key 'c1' is missing"), ("{model: polynomial, c1: 0.1}", "key 'c2' is missing"),
     ("{model: polynomial, c1: 0.1, file: x.yaml}", "c1 is given beside the file that has it"),
     ("{model: network}", "key 'file' is missing"), ("{model: network, file: none.yaml}", "no file 'none.yaml'")],
)  # fmt: skip
def test_a_load_that_says_too_little_or_too_much_is_told(tmp_path: Path, load: str, text: str) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text(f"extends: default.yaml\nname: test\nplant:\n  load: {load}\n")
    assert any(text in problem.text for problem in check_bench(path)), check_bench(path)
