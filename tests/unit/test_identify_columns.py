"""What a column is, in which unit, and which way round."""

import numpy as np
import pytest

from hilplant.failure import Failure
from hilplant.measurements.columns import ROLES, has_unit, parse_columns, unit_scale
from hilplant.measurements.measurement import Channel
from hilplant.measurements.preparation import Preparation, prepare

TIME_S = np.arange(3000) * 1e-3
VOLTS = np.where(TIME_S < 0.5, 0.0, 12.0)
AMPERES = np.where(TIME_S < 0.5, 0.0, 2.0 + np.sin(7.0 * TIME_S))
AS_TOLD = Preparation(offset_a=0.0, current_shift_s=0.0)


@pytest.mark.parametrize(
    ("unit", "size", "written"),
    [("mA", -1e3, "I1*-1"), ("V", 0.1, "I1*10"), ("", 0.1, "I1*10"), ("A", 1e3, "I1[mA]"), ("V", 100.0, "I1[mA]*10")],
)
def test_a_factor_keeps_the_unit_of_the_file_where_that_is_one_of_the_role(
    unit: str, size: float, written: str
) -> None:
    """A clamp the wrong way round in milliamperes stays in milliamperes; volts of a clamp become amperes."""
    data = {
        "U1": Channel(TIME_S, VOLTS),
        "I1": Channel(TIME_S, size * AMPERES, unit),
        "PS": Channel(TIME_S, (TIME_S % 1.0 < 0.05).astype(float)),
    }
    made = prepare(data, parse_columns(f"voltage=U1,current={written},park=PS"), AS_TOLD)
    assert made.current_a == pytest.approx(AMPERES, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("voltage", "write role=NAME"),
        ("volt=U1", "no role 'volt'"),
        ("voltage=U1,voltage=U2", "given twice"),
        ("current=I1[Nm]", "not in 'Nm'"),
        ("current=I1*ten", "'ten' is not a number"),
    ],
)
def test_wrong_columns_are_told(text: str, message: str) -> None:
    with pytest.raises(Failure, match=message.replace("(", r"\(")):
        parse_columns(text)


@pytest.mark.parametrize("unit", ["%", "", "V", "m/s"])
def test_a_role_without_a_unit_comes_in_none(unit: str) -> None:
    assert not any(has_unit(role, unit) for role, own in ROLES.items() if own == "")


@pytest.mark.parametrize(
    ("role", "unit", "scale"),
    [
        ("time", "sec", 1.0),
        ("time", "Minuten", 60.0),
        ("time", "µs", 1e-6),
        ("voltage", "\u03bcV", 1e-6),
        ("current", "kA", 1e3),
    ],
)
def test_a_column_comes_in_the_units_that_a_database_may_have(role: str, unit: str, scale: float) -> None:
    assert unit_scale("", role, unit) == scale
