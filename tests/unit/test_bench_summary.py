"""What `check` says of a sound bench: its figures are those that are known otherwise, and nothing assumed is hidden."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from hilplant.bench import load_bench
from hilplant.bench.summary import summarise, summary_lines
from hilplant.bench.verdict import verdict_on
from hilplant.cli.main import app
from hilplant.resources import shipped

LINKAGE = shipped("config", "linkages", "rhd_slave_driven.yaml").read_text()


def bench_with(folder: Path, plant: str) -> Path:
    path = folder / "bench.yaml"
    path.write_text(f"extends: default.yaml\nname: test\nplant: {plant}\n")
    return path


def test_the_default_bench_has_the_known_sweeps_and_the_masses_of_its_file() -> None:
    """Sweeps: closed form, docs/errata.md. Masses: five published bodies, two arms, two blades."""
    found = summarise(load_bench())
    assert found.left_sweep_deg == pytest.approx(81.889, abs=5e-4)
    assert found.right_sweep_deg == pytest.approx(82.794, abs=5e-4)
    published = 0.0845 + 0.3835 + 0.1157 + 0.6370 + 0.0780
    assert found.moving_mass_kg == pytest.approx(published + 2 * 0.5 + 2 * 0.3)
    assert found.projection_loss_m == 0.0


def test_the_transmission_angle_is_that_of_the_law_of_cosines() -> None:
    """At the crank's dead centres the triangle D-E-F has known sides; its angle at E is farthest from 90 deg there."""
    points = yaml.safe_load(LINKAGE)["points_m"]
    o, a, b, c, d, e, f = (np.array(points[name][:2]) for name in "OABCDEF")
    ground, crank, coupler, rocker = (np.linalg.norm(way) for way in (c - o, a - o, b - a, c - b))
    arm, link, last, far = (np.linalg.norm(way) for way in (d - c, e - d, f - e, f - c))
    side = [np.arccos((ground**2 + rocker**2 - reach**2) / (2 * ground * rocker)) for reach in
            (coupler - crank, coupler + crank)]  # fmt: skip
    at_design = angle_between(o - c, b - c)
    to_far = angle_between(f - c, d - c)
    angles = []
    for turned in side:
        away = to_far + np.sign(at_design) * (turned - abs(at_design))
        apart = arm**2 + far**2 - 2 * arm * far * np.cos(away)
        at_e = np.degrees(np.arccos((link**2 + last**2 - apart) / (2 * link * last)))
        angles.append(min(at_e, 180 - at_e))
    known = pytest.approx(min(angles), abs=0.05)  # D is put on its line, 0.03 mm away
    assert summarise(load_bench()).transmission_angle_deg == known


def angle_between(first: np.ndarray, second: np.ndarray) -> float:
    return float(np.angle(complex(*second) / complex(*first)))


def test_what_the_plant_sends_is_a_small_part_of_the_slowest_usual_bus() -> None:
    bench = load_bench()
    found = summarise(bench)
    assert found.sent_frames_per_s == pytest.approx(sum(1e9 / message.period_ns for message in bench.send))
    assert found.sent_bits_per_s < 0.5 * 125_000


def test_the_bits_of_a_frame_are_those_of_the_standard(tmp_path: Path) -> None:
    """Eight bytes with an identifier of 11 bits: 135 bits at most, the pause between frames included."""
    bench = tmp_path / "bench.yaml"
    bench.write_text(
        "extends: default.yaml\nname: x\nbus:\n  send:\n    MotorStatus: {signals: {MotorCurrent: current_a}}\n"
    )
    found = summarise(load_bench(bench))
    assert (found.sent_frames_per_s, found.sent_bits_per_s) == (100.0, 13500.0)


def test_every_assumed_value_is_named() -> None:
    assumed = summarise(load_bench()).assumed
    for name in ("linkage.left_arm.mass_kg", "linkage.right_blade.mass_kg", "screen.tacky.mu_tacky_1",
                 "blades.left.area_m2", "blades.right.lift", "park_switch.window_deg"):  # fmt: skip
        assert name in assumed
    assert "blades.left.force_n" not in assumed
    assert "park_switch.window_deg" in summarise(load_bench("mechanical")).assumed
    assert "park_switch.reverse_angle_deg" not in summarise(load_bench("depressed")).assumed


def test_a_part_that_is_assumed_as_a_whole_says_so(tmp_path: Path) -> None:
    (tmp_path / "own.yaml").write_text(LINKAGE.replace("status: published", "status: assumed"))
    bench = load_bench(bench_with(tmp_path, "{linkage: own.yaml}"))
    assert "linkage.*" in summarise(bench).assumed
    assert "linkage: all of it" in " ".join(" ".join(summary_lines(bench)).split())


def test_points_out_of_the_plane_are_told_with_what_they_lose(tmp_path: Path) -> None:
    """One joint 20 mm nearer to the viewer: of the bodies on it, the way from B to D is the shortest and loses most."""
    (tmp_path / "own.yaml").write_text(LINKAGE.replace("B: [-0.2240, -0.0218, 0.0]", "B: [-0.2240, -0.0218, 0.02]"))
    bench = load_bench(bench_with(tmp_path, "{linkage: own.yaml}"))
    short = np.hypot(0.2345 - 0.2240, 0.0111 - 0.0218)
    lost = np.hypot(short, 0.02) - short
    assert summarise(bench).projection_loss_m == pytest.approx(lost, rel=1e-9)
    (line,) = [line for line in summary_lines(bench) if "projection" in line]
    assert f"left_rocker is up to {1000 * lost:.3g} mm longer in space" in line


def test_an_assembly_that_describes_the_slave_driven_linkage_is_the_same_wiper(tmp_path: Path) -> None:
    described = """kind: assembly
bodies:
  crank: [O, A]
  coupler: [A, B]
  left_rocker: [B, C, D]
  link: [D, E]
  right_rocker: [E, F]
joints:
  - {revolute: O, bodies: [ground, crank]}
  - {revolute: A, bodies: [crank, coupler]}
  - {revolute: B, bodies: [coupler, left_rocker]}
  - {revolute: C, bodies: [left_rocker, ground]}
  - {revolute: D, bodies: [left_rocker, link]}
  - {revolute: E, bodies: [link, right_rocker]}
  - {revolute: F, bodies: [right_rocker, ground]}
"""
    (tmp_path / "own.yaml").write_text(LINKAGE.replace("kind: slave_driven\n", described))
    bench = load_bench(bench_with(tmp_path, "{linkage: own.yaml}"))
    gap = np.abs(bench.tables - load_bench().tables).max()
    print(f"largest difference in any channel: {gap:.2e}")
    assert gap < 1e-12


def test_a_mistake_in_an_assembly_is_told_at_its_joint(tmp_path: Path) -> None:
    text = LINKAGE.replace(
        "kind: slave_driven\n",
        "kind: assembly\nbodies:\n  crank: [O, A]\njoints:\n  - {revolute: O, bodies: [ground, crank]}\n"
        "  - {revolute: A, bodies: [crank, couple]}\n",
    )
    (tmp_path / "own.yaml").write_text(text)
    verdict = verdict_on(bench_with(tmp_path, "{linkage: own.yaml}"))
    assert "own.yaml:" in verdict.problems[0]
    assert verdict.lines[-1].endswith("1 problem(s)")


def test_the_command_prints_the_summary_and_writes_flat_figures(tmp_path: Path) -> None:
    figures = tmp_path / "check.json"
    run = CliRunner().invoke(app, ["check", "default", "--json", str(figures)])
    assert run.exit_code == 0
    assert run.stdout.startswith("default: nothing is wrong\n  motor ")
    written = json.loads(figures.read_text())
    assert (written["problems"], written["messages"]) == (0, [])
    assert written["left_sweep_deg"] == pytest.approx(81.889, abs=5e-4)
    assert all(not isinstance(value, dict) for value in written.values())


def test_the_command_tells_problems_and_no_summary(tmp_path: Path) -> None:
    run = CliRunner().invoke(app, ["check", str(bench_with(tmp_path, "{screen: ~}"))])
    assert run.exit_code == 1
    assert "the reduced load needs screen beside it" in run.output
    assert "sweep" not in run.output
