"""Pictures of friction, air, motion and joint forces by their commands: what they show, and the numbers beside them."""

import csv
from pathlib import Path

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.cli.main import app
from hilplant.simulation.air_forces import PUBLISHED
from hilplant.simulation.friction_curves import blade_speeds, mu_over_speed, published_sets


def drawn(*words: str) -> None:
    app(["plot", *words], standalone_mode=False)


def table(path: Path) -> dict[str, np.ndarray]:
    with path.open() as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def test_the_published_sets_are_those_of_tables_4_1_and_4_2() -> None:
    """(4.49) and (4.50) written out here, at a speed where nothing is level yet."""
    speed = 30.0
    dry = {1: (0.25, 0.1), 2: (0.5, 0.1), 3: (0.4, 0.3), 4: (0.15, 0.05)}
    for found, (first, second) in zip(published_sets("dry"), dry.values(), strict=True):
        mu = first * np.tanh(second * speed) + 0.75 * np.tanh(7.5 * speed)
        assert mu_over_speed(found, 0.0, np.array([speed])) == pytest.approx(mu)
    six = published_sets("wet")[5]
    by_force = 0.025 * 15.0 + 1.0
    mu = by_force * (0.6 * (np.tanh(6.0 * speed) - np.tanh(0.01 * speed)) + np.tanh(10.0 * speed) - 2e-4 * speed)
    assert six.force_n == 15.0
    assert mu_over_speed(six, 1.0, np.array([speed])) == pytest.approx(mu)


def test_friction_is_drawn_with_the_speeds_in_use(tmp_path: Path) -> None:
    drawn("friction", "default", str(tmp_path / "f.svg"), "--table", str(tmp_path / "f.csv"))
    text = (tmp_path / "f.svg").read_text()
    assert "tacky, assumed" in text and "held from here on" in text and "largest at 60 turns a minute" in text
    columns = table(tmp_path / "f.csv")
    assert columns["mu_dry"][200] == pytest.approx(0.3186 + 1.996, rel=1e-6)
    assert columns["mu_wet"][-1] == columns["mu_wet"][1000]
    drawn("friction", "default", str(tmp_path / "p.svg"), "--published")
    assert "Figure 4-26" in (tmp_path / "p.svg").read_text()


def test_blades_are_as_fast_as_their_arms_turn() -> None:
    """The largest speed is at most the longer arm's length times the largest rate of its rocker, 0.73 of the crank."""
    bench = load_bench("default")
    speeds = blade_speeds(bench, 2.0 * np.pi)
    longest = max(bench.parameters.left_arm.length_m, bench.parameters.right_arm.length_m)
    assert 0.9 * 0.6999 * longest * 2e3 * np.pi < speeds.largest_mm_s <= 0.7288 * longest * 2e3 * np.pi
    assert 0.0 < speeds.median_mm_s < speeds.largest_mm_s


def test_drag_and_lift_at_40_m_s_are_those_of_the_formula(tmp_path: Path) -> None:
    drawn("aero", "spoiler", str(tmp_path / "a.svg"), "--table", str(tmp_path / "a.csv"))
    last = {name: values[-1] for name, values in table(tmp_path / "a.csv").items()}
    pressure = 0.5 * 1.225 * 40.0**2 * 0.07
    assert last["without_spoiler_4_5_drag_n"] == pytest.approx(0.175 * pressure)
    assert last["with_spoiler_4_5_lift_n"] == pytest.approx(-0.0694 * pressure)
    assert last["spoiler_left_drag_n"] == pytest.approx(0.219 * pressure)
    assert PUBLISHED[0].lift == (0.0517, 0.0517)


def test_motion_and_joint_forces_are_drawn_and_written(tmp_path: Path) -> None:
    drawn("motion", "default", str(tmp_path / "m.svg"), "--body", "link", "--table", str(tmp_path / "m.csv"))
    assert "link" in (tmp_path / "m.svg").read_text()
    columns = table(tmp_path / "m.csv")
    assert columns["left_tip_a_x_m"][0] == pytest.approx(columns["left_tip_a_x_m"][-1], abs=1e-9)
    words = ("--screen", "wet", "--vehicle-speed", "20", "--table", str(tmp_path / "j.csv"))
    drawn("joint-forces", "default", str(tmp_path / "j.svg"), *words)
    assert "crank - coupler" in (tmp_path / "j.svg").read_text()
    assert table(tmp_path / "j.csv")["crank_to_coupler_n"].max() > 100.0
