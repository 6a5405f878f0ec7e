"""The motor that was fitted to published no-load measurements: the file is the fit, and the fit is near the rows."""

from pathlib import Path

import numpy as np
import pytest

from hilplant.bench import BenchError, load_bench
from hilplant.models.records import Brush, Motor
from hilplant.motor_bench.no_load_fit import NoLoadFile, fit_no_load, misses_of, read_motor, read_no_load, steady_state
from hilplant.simulation.run import simulate
from hilplant.simulation.scenario import load_scenario

PUBLISHED = ("table_5_6", "table_5_8", "table_5_9")
LIMIT = 0.04


@pytest.fixture(scope="module")
def measured() -> NoLoadFile:
    return read_no_load()


def test_the_published_constants_follow_from_the_rows(measured: NoLoadFile) -> None:
    """The last columns of Table 5-4 as printed, from (5.18): rows and resistances were copied without a slip."""
    constants = [
        (row.supply_v - measured.resistance_of(row.stage) * row.current_a) / row.speed_rad_s for row in measured.rows
    ]
    printed = [0.045794, 0.050548, 0.045147, 0.030872, 0.029847, 0.029223]
    assert constants == pytest.approx(printed, abs=1e-6)
    assert np.mean(constants[:3]) == pytest.approx(0.047163, abs=1e-6)
    assert np.mean(constants[3:]) == pytest.approx(0.029981, abs=1e-6)


def test_one_row_is_left_out_and_it_says_why(measured: NoLoadFile) -> None:
    (row,) = [row for row in measured.rows if row.left_out]
    assert (row.stage, row.supply_v, row.speed_rad_s) == ("slow", 14.0, 245.21)
    assert len(measured.used) == 5


def test_the_shipped_motor_is_what_the_fit_gives(measured: NoLoadFile) -> None:
    fit, motor = fit_no_load(measured), read_motor("table_5_4")
    shipped = (motor.slow.constant_v_s, motor.fast.constant_v_s, motor.damping_n_m_s, motor.coulomb_torque_n_m)
    assert shipped == pytest.approx(
        (fit.slow_constant_v_s, fit.fast_constant_v_s, fit.damping_n_m_s, fit.coulomb_torque_n_m), rel=1e-5
    )
    assert (motor.slow.resistance_ohm, motor.fast.resistance_ohm) == (1.0, 0.8)


def test_the_fit_finds_friction_that_was_put_in(measured: NoLoadFile) -> None:
    """Rows made with a known motor give that motor back."""
    known = Motor(Brush(1.0, 0.0, 0.05), Brush(0.8, 0.0, 0.03), 0.0, 1.7e-4, 0.031, 63.0)
    rows = []
    for row in measured.rows:
        brush = known.slow if row.stage == "slow" else known.fast
        current, speed = steady_state(brush, known.damping_n_m_s, known.coulomb_torque_n_m, row.supply_v)
        rows.append(row.model_copy(update={"current_a": current, "speed_rad_s": speed}))
    fit = fit_no_load(measured.model_copy(update={"rows": rows}))
    assert (fit.slow_constant_v_s, fit.fast_constant_v_s) == pytest.approx((0.05, 0.03), rel=1e-9)
    assert (fit.damping_n_m_s, fit.coulomb_torque_n_m) == pytest.approx((1.7e-4, 0.031), rel=1e-6)


def test_the_fitted_motor_is_within_four_percent_of_every_row_that_counts(measured: NoLoadFile) -> None:
    for miss in misses_of(read_motor("table_5_4"), measured.rows):
        note = "left out: " + miss.row.left_out if miss.row.left_out else ""
        print(f"{miss.row.stage} {miss.row.supply_v:g} V: current {miss.current:+.1%}, speed {miss.speed:+.1%} {note}")
        if not miss.row.left_out:
            assert abs(miss.current) < LIMIT
            assert abs(miss.speed) < LIMIT


def test_the_published_motors_draw_too_little_for_want_of_dry_friction(measured: NoLoadFile) -> None:
    worst = {}
    for name in PUBLISHED:
        misses = misses_of(read_motor(name), measured.used)
        worst[name] = min(miss.current for miss in misses)
        print(f"{name}: currents {worst[name]:+.0%} to {max(miss.current for miss in misses):+.0%}")
    assert worst == pytest.approx({"table_5_6": -0.57, "table_5_8": -0.35, "table_5_9": -0.44}, abs=0.006)


@pytest.mark.parametrize(("stage", "supply_v"), [("slow", 12), ("slow", 16), ("fast", 12), ("fast", 14), ("fast", 16)])
def test_the_whole_step_comes_to_rest_at_the_measured_row(
    measured: NoLoadFile, tmp_path: Path, stage: str, supply_v: float
) -> None:
    """The plant itself, switched on with nothing on its crank, after three seconds: no formula of the fit is used."""
    bench, scenario = tmp_path / "bench.yaml", tmp_path / "scenario.yaml"
    bench.write_text(
        "extends: virtual.yaml\nname: no load\nplant: {motor: motors/table_5_4.yaml, load: {model: none}}\n"
    )
    fast = str(stage == "fast").lower()
    scenario.write_text(
        f"seconds: 3\nsignals: {{relay_on: [[0, true]], relay_fast: [[0, {fast}]], supply_v: [[0, {supply_v}]]}}\n"
    )
    result = simulate(load_bench(bench), load_scenario(scenario))
    (row,) = [row for row in measured.used if (row.stage, row.supply_v) == (stage, supply_v)]
    assert result["current_a"][-1] == pytest.approx(row.current_a, rel=LIMIT)
    assert result["motor_speed_rad_s"][-1] == pytest.approx(row.speed_rad_s, rel=LIMIT)


def test_a_file_that_cannot_be_read_is_told_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "rows.yaml"
    path.write_text("name: x\nsource: y\nstatus: measured\nresistance_ohm: {slow: 1, fast: 1}\nrows: []\n")
    with pytest.raises(BenchError, match=r"rows\.yaml:5: rows must have at least 1 entry, not 0"):
        read_no_load(path)
