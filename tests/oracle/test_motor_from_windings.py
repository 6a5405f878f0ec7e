"""Constants counted from coils against the flux of (3.16), integrated and differentiated numerically."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from hilplant.bench.parts import MotorFile
from hilplant.cli.main import app
from hilplant.motor_bench.windings import Armature, coil_constant_v_s, counted
from hilplant.resources import shipped

TESLA, LENGTH_M, DIAMETER_M = 0.4, 0.03, 0.042
GRID = 7200  # points of a turn
THESIS = Armature(12, 5, 45.0)


def flux_of_coils() -> np.ndarray:
    """The integral of the radial field (3.13) from angle 0 on, trapezoidal [V s], at the grid's points."""
    angle = (np.arange(GRID) + 0.5) * 2.0 * np.pi / GRID
    field = np.where(angle < np.pi, TESLA, -TESLA)
    return np.concatenate([[0.0], np.cumsum(field)]) * (2.0 * np.pi / GRID) * LENGTH_M * DIAMETER_M / 2.0


def path_constants(armature: Armature, fast: bool) -> tuple[float, float]:
    """Back-EMF over speed of both current paths: sum of their coils' fluxes, differentiated, mean over a slot."""
    total = flux_of_coils()
    slot, half = GRID // armature.coils, armature.pitch_slots * GRID // armature.coils / 2
    rotor = np.arange(slot)
    constants = [0.0, 0.0]
    for coil in range(armature.coils):
        axis = rotor + coil * slot  # from where a coil links no flux, of which the brushes' angle counts
        sides = [(axis - GRID / 4 + sign * half) for sign in (1.0, -1.0)]
        linked = [
            np.interp(np.mod(np.add.outer(side, [-0.5, 0.5]), GRID), np.arange(GRID + 1), total) for side in sides
        ]
        rate = np.diff(linked[0] - linked[1], axis=1)[:, 0] / (2.0 * np.pi / GRID)
        turned = np.mod(axis + 0.5, GRID) * 360.0 / GRID
        one = (turned >= (armature.fast_brush_deg if fast else 0.0)) & (turned < 180.0)
        constants[0] += float((rate * one).mean())
        constants[1] -= float((rate * ~one).mean())
    return constants[0], constants[1]


@pytest.mark.parametrize(("coils", "pitch"), [(12, 5), (12, 6), (8, 3), (10, 4), (16, 7), (20, 9)])
@pytest.mark.parametrize("brush_deg", [30.0, 45.0, 60.0, 72.0])
def test_both_paths_have_half_of_what_is_counted(coils: int, pitch: int, brush_deg: float):
    armature = Armature(coils, pitch, brush_deg)
    for fast in (False, True):
        wanted = coil_constant_v_s(TESLA, LENGTH_M, DIAMETER_M) * counted(armature, fast).between_brushes
        assert path_constants(armature, fast) == pytest.approx((wanted, wanted), rel=1e-3)


def test_twelve_coils_are_those_of_the_thesis_at_every_position_of_the_rotor():
    slow, fast = counted(THESIS, False), counted(THESIS, True)
    assert (slow.least, slow.mean, slow.most) == (10.0, 10.0, 10.0), "(3.11), (3.27)"
    assert (fast.least, fast.mean, fast.most) == (8.0, 8.0, 8.0), "(3.12), (3.28)"


@pytest.mark.parametrize("brush_deg", [20.0, 33.0, 52.5, 80.0])
def test_the_mean_follows_the_closed_form(brush_deg: float):
    """A brush takes (angle - half of what the pitch lacks)/slot coils from each path."""
    lost = 2.0 * (brush_deg - 15.0) / 30.0
    assert counted(Armature(12, 5, brush_deg), True).mean == pytest.approx(10.0 - lost, abs=2e-3)


def test_the_measured_sets_lie_where_the_documentation_says():
    ratios = []
    for path in shipped("config", "motors").glob("*.yaml"):
        motor = MotorFile.model_validate(yaml.safe_load(path.read_text()))
        if motor.status == "assumed":  # was never measured
            continue
        ratios.append(motor.fast.constant_v_s / motor.slow.constant_v_s)
    assert (min(ratios), max(ratios)) == pytest.approx((0.66, 0.75), abs=0.005)


def test_the_command_writes_the_motor(tmp_path: Path):
    out = tmp_path / "motor.yaml"
    readings = shipped("config", "measurements", "windings_12_coils.yaml")
    result = CliRunner().invoke(app, ["motor", str(readings), "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert "10 K_t slow, 8 K_t fast" in result.output
    assert "0.800" in result.output
    written = yaml.safe_load(out.read_text())
    assert written["slow"]["constant_v_s"] == pytest.approx(5 * 18 * 0.4 * 0.03 * 0.042)
    assert written["fast"]["constant_v_s"] == pytest.approx(4 * 18 * 0.4 * 0.03 * 0.042)


def test_a_coil_wider_than_half_a_turn_is_refused(tmp_path: Path):
    text = shipped("config", "measurements", "windings_12_coils.yaml").read_text()
    bad = tmp_path / "bad.yaml"
    bad.write_text(text.replace("pitch_slots: 5", "pitch_slots: 7"))
    result = CliRunner().invoke(app, ["motor", str(bad), "--out", str(tmp_path / "m.yaml")])
    assert "pitch_slots must be at most half of coils, 6" in str(result.exception)
