"""Tables of a decay and a run-down: units and names decide, in any order; what cannot be told is refused."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.motor_bench.motor_file import motor_from_readings

#: Truth: R = 1 ohm, so L = 8 mH; dry friction alone, so that the speed falls in a straight line, J = T / 500 per s2.
TAU_S, FALL_RAD_S2 = 0.008, 500.0
MODE = {"resistance_ohm": 1.0, "no_load": [[12, 1.0, 240.0], [16, 1.0, 330.0]], "time_constant_s": TAU_S}
TIME_S = np.linspace(0.0, 0.06, 301)
AMPERES = 2.0 * np.exp(-TIME_S / TAU_S)
SPEED = 300.0 - FALL_RAD_S2 * TIME_S * 5.0
VOLTS, COUNT = 13.5 - 10.0 * TIME_S, np.arange(len(TIME_S))
Columns = list[tuple[str, Floats]]


def readings(folder: Path, columns: Columns, role: str, head: bool = True) -> Path:
    table = np.column_stack([values for _, values in columns])
    names = [",".join(name for name, _ in columns)] if head else []
    rows = [",".join(f"{value:.9g}" for value in row) for row in table]
    (folder / "table.csv").write_text("\n".join([*names, *rows]) + "\n")
    slow = {key: value for key, value in MODE.items() if key != "time_constant_s" or role == "speed"}
    own = {"run_down": "table.csv"} if role == "speed" else {}
    slow |= {} if own else {"decay": "table.csv"}
    given = {"damping_n_m_s": 0.0} | ({} if own else {"inertia_kg_m2": 2e-5})
    text = {"kind": "bench", "name": "m", "source": "a test", "status": "measured", "gear_ratio": 63, "slow": slow,
            "fast": MODE, "given": given, **own}  # fmt: skip
    (folder / "readings.yaml").write_text(yaml.safe_dump(text))
    return folder / "readings.yaml"


TIMES = [
    ("t [s]", TIME_S),
    ("time_s", TIME_S),
    ("Time (ms)", 1e3 * TIME_S),
    ("t / µs", 1e6 * TIME_S),
    ("t_ms", 1e3 * TIME_S),
]
CURRENTS = [
    ("i [A]", AMPERES), ("i", AMPERES), ("current_a", AMPERES), ("I_mot [mA]", 1e3 * AMPERES),
    ("Ampl in kA", 1e-3 * AMPERES),
]  # fmt: skip
SPEEDS = [
    ("w [rad/s]", SPEED), ("omega", SPEED), ("n [rpm]", SPEED * 30.0 / np.pi), ("n [1/min]", SPEED * 30.0 / np.pi),
    ("n [min⁻¹]", SPEED * 30.0 / np.pi), ("Drehzahl [U/min]", SPEED * 30.0 / np.pi),
    ("v [°/s]", np.rad2deg(SPEED)),
]  # fmt: skip
OTHERS: list[Columns] = [[], [("U [V]", VOLTS)], [("", COUNT)], [("U [V]", VOLTS), ("T [°C]", VOLTS)]]


@pytest.mark.parametrize("others", OTHERS)
@pytest.mark.parametrize("column", CURRENTS + SPEEDS)
@pytest.mark.parametrize("time", TIMES)
def test_units_and_names_decide(
    tmp_path: Path, time: tuple[str, Floats], column: tuple[str, Floats], others: Columns
) -> None:
    role = "current" if column in CURRENTS else "speed"
    for order in ([*others, time, column], [column, *others, time]):
        found = motor_from_readings(readings(tmp_path, order, role), tmp_path / "motor.yaml").values
        if role == "current":
            assert found["slow_inductance_henry"].n == pytest.approx(TAU_S, rel=1e-5)
        else:
            inertia = found["coulomb_torque_n_m"].n / (5.0 * FALL_RAD_S2)
            assert found["inertia_kg_m2"].n == pytest.approx(inertia, rel=1e-5)


def test_two_columns_without_a_head_are_seconds_and_amperes(tmp_path: Path) -> None:
    path = readings(tmp_path, [("", TIME_S), ("", AMPERES)], "current", head=False)
    found = motor_from_readings(path, tmp_path / "motor.yaml").values
    assert found["slow_inductance_henry"].n == pytest.approx(TAU_S, rel=1e-5)


@pytest.mark.parametrize(
    ("columns", "role", "text"),
    [
        (["t [s]", "i [V]"], "current", "no column is known by unit or name as the current among i [V]; "),
        (["t [s]", "i [rad/s]"], "current", "write it as 'i [A]' or 'i [mA]'"),
        (["t [s]", "w [V]"], "speed", "no column is known by unit or name as the speed among w [V]; "),
        (["t [s]", "w [Hz]"], "speed", "write it as 'w [rad/s]' or 'n [rpm]'"),
        (["t [s]", "n"], "speed", "as the speed among n; "),
        (["t [s]", "i_mA"], "current", "as the current among i_mA; "),
        (
            ["t [s]", "i1 [A]", "i2 [mA]"],
            "current",
            "more than one column is known by unit or name as the current among i1 [A], i2 [mA]; ",
        ),
        (["x_ms", "i [A]"], "current", "no column is known as the time among x_ms, i; write 't [s]' or 't [ms]'"),
        (["a", "b"], "speed", "as the time among a, b; "),
        (["t [V]", "i [A]"], "current", "no column is known as the time among t, i; "),
    ],
)
def test_what_cannot_be_told_is_refused_in_one_line(tmp_path: Path, columns: list[str], role: str, text: str) -> None:
    values = [TIME_S, *([SPEED] * (len(columns) - 1))]
    path = readings(tmp_path, list(zip(columns, values, strict=True)), role)
    with pytest.raises(Failure) as told:
        motor_from_readings(path, tmp_path / "motor.yaml")
    assert text in str(told.value)
    assert "table.csv" in str(told.value) and "\n" not in str(told.value)
    assert not (tmp_path / "motor.yaml").exists()


@pytest.mark.parametrize(
    ("values", "role", "text"),
    [
        (AMPERES[::-1], "current", "column 'i': the current shows no exponential decay"),
        (SPEED * 0.0 + 300.0, "speed", "column 'w': the speed does not fall by a tenth"),
    ],
)
def test_a_law_that_does_not_hold_names_file_and_column(tmp_path: Path, values: Floats, role: str, text: str) -> None:
    name = "i [A]" if role == "current" else "w [rad/s]"
    path = readings(tmp_path, [("t [s]", TIME_S), (name, values)], role)
    with pytest.raises(Failure, match=r"table\.csv, " + text):
        motor_from_readings(path, tmp_path / "motor.yaml")
