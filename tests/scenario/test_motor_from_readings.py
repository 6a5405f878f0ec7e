"""`hilplant motor`: readings of a known motor give that motor, in a file that a bench takes; bad ones are told."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp
from typer.testing import CliRunner

from hilplant.bench import check_bench, load_bench
from hilplant.cli.main import app
from hilplant.failure import Failure
from hilplant.motor_bench.no_load_fit import read_motor, steady_state
from hilplant.motor_bench.typical import typical_motor
from hilplant.resources import shipped

OHM, HENRY, CONSTANT = (1.2, 0.9), (3.1e-3, 2.4e-3), (0.045, 0.033)
INERTIA, DAMPING, DRY, RATIO = 2e-5, 1e-4, 0.045, 63.0
HEAD = {"name": "known", "source": "a test", "status": "measured", "gear_ratio": RATIO}


def no_load(brush: int, volts: float) -> list[float]:
    """Voltage, current and speed of V = R i + K w, K i = b w + T."""
    matrix = [[OHM[brush], CONSTANT[brush]], [CONSTANT[brush], -DAMPING]]
    current, speed = np.linalg.solve(matrix, [volts, DRY])
    return [volts, float(current), float(speed)]


def bench_readings(folder: Path) -> dict[str, Any]:
    """Readings of one thing after the other; decay and run-down by an integrator, as a scope would keep them."""
    time_s = np.linspace(0.0, 0.02, 400)
    for name, ohm, henry in zip(("slow", "fast"), OHM, HENRY, strict=True):
        table = np.column_stack([time_s, 5.0 * np.exp(-time_s * ohm / henry)])
        np.savetxt(folder / f"{name}.csv", table, delimiter=",", header="time_s,current_a", comments="")
    turning = solve_ivp(lambda _, w: (-DAMPING * w - DRY) / INERTIA, (0.0, 0.1), [250.0], max_step=1e-3, rtol=1e-10)
    table = np.column_stack([turning.t, turning.y[0]])
    np.savetxt(folder / "down.csv", table, delimiter=";", header="t;w", comments="")
    modes = {
        name: {"blocked": [[2.0, 2.0 / ohm], [3.0, 3.0 / ohm]], "no_load": [no_load(k, 12.0), no_load(k, 16.0)],
               "decay": f"{name}.csv"}
        for k, (name, ohm) in enumerate(zip(("slow", "fast"), OHM, strict=True))
    }  # fmt: skip
    return HEAD | {"kind": "bench", "run_down": "down.csv", **modes}


def sheet() -> dict[str, Any]:
    modes = {}
    for k, name in enumerate(("slow", "fast")):
        volts, current, speed = no_load(k, 13.5)
        stall = volts / OHM[k]
        modes[name] = {
            "voltage_v": volts, "no_load_current_a": current, "no_load_rpm": speed / RATIO * 60.0 / (2.0 * np.pi),
            "stall_current_a": stall, "stall_torque_n_m": 0.6 * RATIO * (CONSTANT[k] * stall - DRY),
        }  # fmt: skip
    given = {"slow_inductance_henry": HENRY[0], "fast_inductance_henry": HENRY[1], "inertia_kg_m2": INERTIA}
    return HEAD | {"kind": "data_sheet", "tolerance": 0.1, "given": given, **modes}


def run(folder: Path, readings: dict[str, Any]) -> dict[str, float]:
    (folder / "readings.yaml").write_text(yaml.safe_dump(json.loads(json.dumps(readings))))
    arguments = ["motor", str(folder / "readings.yaml"), "--out", str(folder / "motor.yaml")]
    result = CliRunner().invoke(app, [*arguments, "--json", str(folder / "figures.json")], catch_exceptions=True)
    if isinstance(result.exception, Failure):
        raise result.exception
    assert result.exit_code == 0, result.output
    figures: dict[str, float] = json.loads((folder / "figures.json").read_text())
    return figures


def assert_known(found: dict[str, float]) -> None:
    for k, name in enumerate(("slow", "fast")):
        truth = (("resistance_ohm", OHM), ("inductance_henry", HENRY), ("constant_v_s", CONSTANT))
        for part, values in truth:
            assert found[f"{name}_{part}"] == pytest.approx(values[k], rel=1e-6)
    assert found["damping_n_m_s"] == pytest.approx(DAMPING, rel=1e-6)
    assert found["coulomb_torque_n_m"] == pytest.approx(DRY, rel=1e-6)
    assert found["inertia_kg_m2"] == pytest.approx(INERTIA, rel=1e-4)


def test_readings_of_a_known_motor_give_it_in_a_file_that_a_bench_takes(tmp_path: Path) -> None:
    assert_known(run(tmp_path, bench_readings(tmp_path)))
    bench = tmp_path / "bench.yaml"
    bench.write_text("extends: default.yaml\nname: mine\nplant: {motor: motor.yaml}\n")
    assert check_bench(bench) == []
    assert load_bench(bench).parameters.motor.fast.constant_v_s == pytest.approx(CONSTANT[1], rel=1e-6)


def test_a_data_sheet_gives_it_too_with_errors_and_what_was_given_marked(tmp_path: Path) -> None:
    found = run(tmp_path, sheet())
    assert_known(found)
    assert found["gear_efficiency"] == pytest.approx(0.6, rel=1e-6)
    assert found["slow_resistance_ohm_standard_error"] == pytest.approx(OHM[0] * np.hypot(0.1, 0.1) / np.sqrt(3.0))
    written = yaml.safe_load((tmp_path / "motor.yaml").read_text())
    assert written["assumed"] == ["inertia_kg_m2"] and written["slow"]["assumed"] == ["inductance_henry"]


def test_the_published_readings_give_the_published_averages(tmp_path: Path) -> None:
    """Table 5-4: 0.047163 and 0.029981; Table 5-5: 8.0 and 6.4 mH."""
    found = run(tmp_path, yaml.safe_load(shipped("config", "measurements", "table_5_4_readings.yaml").read_text()))
    assert (round(found["slow_constant_v_s"], 6), round(found["fast_constant_v_s"], 6)) == (0.047163, 0.029981)
    assert (found["slow_inductance_henry"], found["fast_inductance_henry"]) == pytest.approx((0.008, 0.0064))


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"given": {}}, "nothing tells slow_inductance_henry: give time_constant_s or decay under slow"),
        ({"gear_ration": 63}, "unknown key 'gear_ration', did you mean 'gear_ratio'?"),
        ({"kind": "guess"}, "kind 'guess'; known: bench, data_sheet"),
        ({"tolerance": -1.0}, "tolerance must be greater than or equal to 0"),
        ({"slow": sheet()["fast"], "fast": sheet()["slow"]}, "no-load speed must be above the slow one's"),
        ({"given": sheet()["given"] | {"gear_efficiency": 0.7}}, "gear_efficiency is given, and the readings tell it"),
    ],
)
def test_what_makes_no_motor_is_told_with_its_file(tmp_path: Path, change: dict[str, Any], text: str) -> None:
    with pytest.raises(Failure, match=r"readings\.yaml") as told:
        run(tmp_path, sheet() | change)
    assert text in str(told.value)
    assert not (tmp_path / "motor.yaml").exists()


def test_two_ways_to_the_same_parameter_and_an_impossible_constant_are_told(tmp_path: Path) -> None:
    readings = bench_readings(tmp_path)
    with pytest.raises(Failure, match=r"readings\.yaml:\d+: armature and run_down tell the same; keep one"):
        run(tmp_path, readings | {"armature": {"mass_kg": 0.3, "radius_m": 0.02}})
    slow = readings["slow"] | {"time_constant_s": 0.008}
    with pytest.raises(Failure, match="time_constant_s and decay tell the same"):
        run(tmp_path, readings | {"slow": slow})
    readings["slow"]["no_load"] = [[2.0, 20.0, 200.0], [3.0, 30.0, 300.0]]
    with pytest.raises(Failure, match=r"slow_constant_v_s comes out as .* not above 0"):
        run(tmp_path, readings | {"given": {"damping_n_m_s": 0.0}})


def test_an_efficiency_above_1_within_the_tolerance_of_the_sheet_is_1(tmp_path: Path) -> None:
    readings = sheet()
    for mode in ("slow", "fast"):
        readings[mode]["stall_torque_n_m"] *= 1.03 / 0.6
    assert run(tmp_path, readings)["gear_efficiency"] == 1.0


def test_a_negative_friction_and_a_missing_table_are_told(tmp_path: Path) -> None:
    readings = bench_readings(tmp_path)
    readings["slow"]["no_load"] = readings["fast"]["no_load"] = [[12.0, 2.0, 200.0], [16.0, 1.0, 300.0]]
    with pytest.raises(Failure, match="damping_n_m_s comes out below 0"):
        run(tmp_path, readings)
    with pytest.raises(Failure, match=r"absent\.csv: cannot be read"):
        run(tmp_path, bench_readings(tmp_path) | {"run_down": "absent.csv"})


#: The shipped sets that are wiper motors of a car; what a sheet does not tell, by the name in the motor file.
CARS = ("table_5_4", "table_5_6", "table_5_8", "table_5_9", "production_car")
LACKING = ("slow_resistance_ohm", "slow_no_load_current_a", "slow_inductance_henry", "fast_resistance_ohm",
           "fast_no_load_current_a", "fast_inductance_henry", "inertia_kg_m2", "gear_ratio")  # fmt: skip


def speeds_alone(name: str, volts: float) -> dict[str, Any]:
    """The sheet of a shipped motor that tells nothing but its speeds."""
    motor = read_motor(name)
    friction = motor.damping_n_m_s, motor.coulomb_torque_n_m
    modes = {
        mode: {
            "voltage_v": volts,
            "no_load_rpm": steady_state(brush, *friction, volts)[1] / motor.gear_ratio * 30 / np.pi,
        }
        for mode, brush in (("slow", motor.slow), ("fast", motor.fast))
    }
    return {"kind": "data_sheet", "name": "alone", "source": "a test", "status": "published", **modes}


@pytest.mark.parametrize("volts", [12.0, 13.5])
@pytest.mark.parametrize("name", CARS)
def test_speeds_alone_give_a_motor_of_those_speeds_within_its_errors(tmp_path: Path, name: str, volts: float) -> None:
    sheet, truth = speeds_alone(name, volts), read_motor(name)
    found = run(tmp_path, sheet | {"assume": "typical"})
    told = {"inertia_kg_m2": truth.inertia_kg_m2, "gear_ratio": truth.gear_ratio, "damping_n_m_s": truth.damping_n_m_s}
    for mode, brush in (("slow", truth.slow), ("fast", truth.fast)):
        told |= {f"{mode}_{part}": value for part, value in brush._asdict().items()}
    for key, value in told.items():
        assert abs(found[key] - value) < 2.0 * found[f"{key}_standard_error"], key
    made = read_motor(tmp_path / "motor.yaml")
    for mode, brush in (("slow", made.slow), ("fast", made.fast)):
        _, speed = steady_state(brush, made.damping_n_m_s, made.coulomb_torque_n_m, volts)
        assert speed / made.gear_ratio * 30 / np.pi == pytest.approx(sheet[mode]["no_load_rpm"], rel=1e-6)
    written = yaml.safe_load((tmp_path / "motor.yaml").read_text())
    assert written["slow"]["assumed"] == written["fast"]["assumed"] == ["resistance_ohm", "inductance_henry"]
    assert set(written["assumed"]) == {"damping_n_m_s", "coulomb_torque_n_m", "inertia_kg_m2", "gear_ratio"}


def test_all_that_is_missing_is_told_at_once_and_its_typical_values_are_offered(tmp_path: Path) -> None:
    with pytest.raises(Failure) as told:
        run(tmp_path, speeds_alone("table_5_9", 12.0))
    asked, offered = str(told.value).split("or `assume: typical` for ")
    for name in LACKING:
        assert f"nothing tells {name}: give " in asked
        assert f"{name} {typical_motor().values[name].n:g} +- " in offered


@pytest.mark.parametrize("name", LACKING)
def test_a_typical_value_stands_for_what_is_missing_and_for_nothing_else(tmp_path: Path, name: str) -> None:
    readings = sheet() | {"tolerance": 0.0}
    whole = run(tmp_path, readings)
    mode, _, part = name.partition("_")
    if name in readings["given"]:
        del readings["given"][name]
    elif mode in readings:
        del readings[mode]["stall_current_a" if part == "resistance_ohm" else part]
        readings[mode].pop("stall_torque_n_m")
    else:
        del readings[name]
    with pytest.raises(Failure, match=f"readings.yaml: nothing tells {name}: give [^;]*; or `assume: typical` for "):
        run(tmp_path, readings)
    found = run(tmp_path, readings | {"assume": "typical"})
    if name in found:
        assert (found[name], found[f"{name}_standard_error"]) == pytest.approx(
            (typical_motor().values[name].n, typical_motor().values[name].s)
        )
    other = "fast" if mode == "slow" else "slow"
    if name != "gear_ratio":
        for each in ("resistance_ohm", "inductance_henry", "constant_v_s"):
            assert found[f"{other}_{each}"] == pytest.approx(whole[f"{other}_{each}"])


@pytest.mark.parametrize(
    ("slow", "text"),
    [
        ({"voltage_v": 24.0, "no_load_rpm": 40.0}, "motors for 9 to 16 V, not for 24 V: give slow_resistance_ohm"),
        ({"voltage_v": 12.0, "no_load_rpm": 40.0, "stall_torque_n_m": 18.0}, "needs stall_current_a beside it"),
        ({"voltage_v": 12.0, "no_load_rpm": 40.0, "stall_current_a": 9.0, "resistance_ohm": 1.0}, "tell the same"),
        ({"voltage_v": 12.0, "no_load_rpm": 60.0}, "the fast speed's no-load speed must be above the slow one's"),
    ],
)
def test_what_typical_values_do_not_help_is_told(tmp_path: Path, slow: dict[str, float], text: str) -> None:
    with pytest.raises(Failure, match=text):
        run(tmp_path, speeds_alone("table_5_9", 12.0) | {"assume": "typical", "slow": slow})


def test_a_meter_s_resistance_stands_for_the_stall_current(tmp_path: Path) -> None:
    readings = sheet()
    for mode, ohm in zip(("slow", "fast"), OHM, strict=True):
        del readings[mode]["stall_current_a"]
        readings[mode]["resistance_ohm"] = ohm
    assert_known(run(tmp_path, readings))


@pytest.mark.parametrize(("fast_current", "zero"), [(0.93, "damping_n_m_s"), (1.6, "coulomb_torque_n_m")])
def test_a_friction_below_0_within_its_error_is_0_and_keeps_its_error(
    tmp_path: Path, fast_current: float, zero: str
) -> None:
    readings = sheet()
    current = readings["slow"]["no_load_current_a"] * CONSTANT[0] / CONSTANT[1]
    readings["fast"]["no_load_current_a"] = current * fast_current
    found = run(tmp_path, readings)
    other = ({"damping_n_m_s", "coulomb_torque_n_m"} - {zero}).pop()
    assert found[zero] == 0.0 < found[f"{zero}_standard_error"]
    assert found[other] > 0.0
    with pytest.raises(Failure, match=f"{zero} comes out below 0"):
        run(tmp_path, readings | {"tolerance": 0.001})
