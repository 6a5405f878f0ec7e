"""The studies of the mechanics: the source's checks hold, the wiping table adds up, and pictures are drawn."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from hilplant.bench import Bench, load_bench
from hilplant.cli.main import app
from hilplant.failure import Failure
from hilplant.models.tables import GRAVITY, POINTS
from hilplant.plots.mechanics import plot_conditions, plot_torque
from hilplant.resources import shipped
from hilplant.simulation.crank_torque import WETNESS, Conditions, crank_torque
from hilplant.simulation.five_wipes import five_wipes, shape_difference
from hilplant.thesis.mechanics_studies import solver_study
from hilplant.thesis.thesis_checks import Check, thesis_checks
from hilplant.thesis.wiping import INDEPENDENT, demands, wiping
from hilplant.units import TURN_RAD

BENCH = load_bench("default")


@pytest.fixture(scope="module")
def checks() -> list[Check]:
    return thesis_checks(BENCH)


def test_every_check_of_the_source_holds(checks: list[Check]) -> None:
    assert [check for check in checks if not check.holds] == []
    assert {check.where for check in checks} >= {"Table 3-1", "Figure 3-17", "Figure 3-22", "Figure 4-32", "Table 5-4"}


def test_the_measured_row_that_does_not_fit_is_shown_and_named(checks: list[Check]) -> None:
    (named,) = [check for check in checks if "left out" in check.what]
    assert "slow, 14 V" in named.what
    assert "+11." in named.ours


def test_a_slow_even_turn_against_gravity_alone_is_gravity_alone() -> None:
    """Without force on the screen, at a speed at which M' does nothing, the torque is the table's gravity."""
    bench = load_bench("default")
    bench.input_row[:] = _without_force(bench.input_row)
    knots = np.linspace(0.0, TURN_RAD, len(bench.tables))[:-1]
    torque = crank_torque(bench, knots, 1e-9, Conditions(WETNESS["dry"]))
    assert torque == pytest.approx(bench.tables[:-1, GRAVITY, 0], abs=1e-12)


def _without_force(row: np.ndarray) -> np.ndarray:
    from hilplant.signals import INPUT_INDEX

    changed = row.copy()
    changed[[INPUT_INDEX["left_force"], INPUT_INDEX["right_force"]]] = 0.0
    return changed


def test_what_is_called_friction_is_what_the_formulas_give() -> None:
    """Wet and without wind: |J| F mu(|J w|) of both blades, (4.50) written out once more."""
    still, *_ = five_wipes(BENCH)
    knots, ways = np.linspace(0.0, TURN_RAD, len(BENCH.tables)), np.abs(BENCH.tables[:, POINTS : POINTS + 2, 0])
    curve, force = BENCH.parameters.load.friction, BENCH.parameters.load.left_blade.force_n
    v = np.minimum(1000.0 * ways * TURN_RAD, curve.velocity_limit_mm_s)
    stribeck = curve.wet_1 * (np.tanh(curve.wet_2 * v) - np.tanh(curve.wet_3 * v))
    level = curve.wet_4 * np.tanh(curve.wet_5 * v) - curve.wet_6 * v
    torque = np.sum(ways * force * (curve.wet_7 * force + curve.wet_4) * (stribeck + level), axis=1)
    smooth = np.abs(np.interp(still.crank_rad, knots, ways.min(axis=1))) > 0.03
    assert still.friction_n_m[smooth] == pytest.approx(np.interp(still.crank_rad, knots, torque)[smooth], rel=1e-3)


def test_drag_takes_from_the_forward_wipe_what_it_adds_to_the_reverse_one() -> None:
    """Over a whole turn a constant drag does no work, so the mean torque changes by friction alone."""
    still, _, fast, *_ = five_wipes(BENCH)
    assert fast.forward_n_m < still.forward_n_m
    assert fast.reverse_n_m > still.reverse_n_m
    rise = fast.reverse_n_m - still.reverse_n_m
    fall = still.forward_n_m - fast.forward_n_m
    assert fall == pytest.approx(rise, rel=0.25)


def test_the_wiper_is_faster_on_more_volts_on_wet_glass_and_on_the_fast_brush() -> None:
    rows = {(row.supply_v, row.screen, row.stage): row for row in wiping(BENCH, (12.0, 13.5))}
    cycles = {case: row.cycles_per_minute for case, row in rows.items()}
    assert all(cycles[13.5, screen, stage] > cycles[12.0, screen, stage] for _, screen, stage in rows)
    assert all(cycles[supply, "wet", stage] > cycles[supply, "dry", stage] for supply, _, stage in rows)
    assert all(cycles[supply, screen, "fast"] > cycles[supply, screen, "slow"] for supply, screen, _ in rows)
    assert all(row.peak_current_a > row.mean_current_a > 0.0 for row in rows.values())
    fast, slow, apart = demands(list(rows.values()), 13.5)
    assert (fast.met, slow.met, apart.met) == (True, True, False)
    assert apart.found == pytest.approx(fast.found - slow.found)


def test_a_wiper_that_stands_makes_no_cycles(tmp_path: Path) -> None:
    rows = wiping(BENCH, (1.0,))
    assert [row.cycles_per_minute for row in rows if row.screen == "dry"] == [0.0, 0.0]


def test_gravity_and_masses_explain_what_an_integration_without_them_gives(tmp_path: Path) -> None:
    """Without gravity the default bench comes half-way to it; with weightless arms and blades it lies beyond."""
    level, weightless = _level_bench(tmp_path, "level", None), _level_bench(tmp_path, "weightless", 0.0)
    for stage, independent in INDEPENDENT.items():
        default, level_cycles, most = (_wet_cycles(bench, stage) for bench in (BENCH, level, weightless))
        print(f"\n{stage}: {default:.2f}, level {level_cycles:.2f}, weightless {most:.2f}; {independent}", end="")
        assert default < level_cycles < independent < most


def _wet_cycles(bench: Bench, stage: str) -> float:
    (row,) = [row for row in wiping(bench, (13.5,)) if (row.screen, row.stage) == ("wet", stage)]
    return row.cycles_per_minute


def _level_bench(folder: Path, name: str, mass_kg: float | None) -> Bench:
    """Return the default bench on a screen that lies flat, with arms and blades of this mass if it is given."""
    screen, linkage = (yaml.safe_load(shipped("config", *path).read_text()) for path in
                       (("screens", "table_5_9.yaml"), ("linkages", "rhd_slave_driven.yaml")))  # fmt: skip
    screen["angle_rad"] = 1.5707
    for part in ("left_arm", "right_arm", "left_blade", "right_blade"):
        linkage[part] |= {} if mass_kg is None else {"mass_kg": mass_kg}
    for key, content in (("screen", screen), ("linkage", linkage)):
        (folder / f"{name}_{key}.yaml").write_text(yaml.safe_dump(content))
    plant = f"plant: {{screen: {name}_screen.yaml, linkage: {name}_linkage.yaml}}"
    (folder / f"{name}.yaml").write_text(f"extends: default.yaml\nname: {name}\n{plant}\n")
    return load_bench(folder / f"{name}.yaml")


def test_a_load_without_friction_has_no_shape_to_compare() -> None:
    still, *_, dry = five_wipes(load_bench("polynomial"))
    assert shape_difference(dry, still) == 0.0


def test_the_step_is_judged_apart_from_the_park_circuit() -> None:
    """A bench whose park circuit would run on to park when switched off is within the bound as well."""
    found = solver_study("mechanical")
    assert found.holds
    assert found.figures["park_angle_rms_percent"] < 0.05


@pytest.mark.parametrize("draw", [plot_torque, plot_conditions])
def test_pictures_are_drawn_and_a_place_that_does_not_exist_is_told(draw, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    draw(BENCH, tmp_path / "picture.png")
    assert (tmp_path / "picture.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(Failure, match="cannot be written"):
        draw(BENCH, tmp_path / "nowhere" / "picture.png")


def test_the_commands_print_tables_and_write_figures(tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["study", "thesis", "--json", str(tmp_path / "thesis.json")])
    assert done.exit_code == 0, done.output
    assert "Table 5-4" in done.output
    assert json.loads((tmp_path / "thesis.json").read_text())["failed"] == 0
    done = CliRunner().invoke(app, ["plot", "positions", "default", str(tmp_path / "wiper.png")])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "wiper.png").stat().st_size > 10_000
