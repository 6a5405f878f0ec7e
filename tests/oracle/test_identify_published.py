"""Tables 5-2 to 5-5 of the thesis from their inputs: every printed number is reached or explained by rounding."""

import math
from typing import Any

import pytest

from hilplant import resources
from hilplant.checked_yaml.yaml_reader import read_text
from hilplant.thesis.published import as_table, figures, published_lines
from hilplant.thesis.rounding import cut_to, half_digit, reachable, rounds_to

LINES = {(line.table, line.name): line for line in published_lines()}


def load_file() -> dict[str, Any]:
    path = resources.shipped("config", "measurements", "table_5_2.yaml")
    data: dict[str, Any] = read_text(path.read_text(), "table_5_2.yaml").data
    return data


#: Those that are not reached to the last digit, and why.
EXPLAINED = {
    ("5-2", "slow b1 identified"): "cut",
    ("5-3", "slow gain_a_v_s"): "rounding",
    ("5-3", "fast gain_a_v_s"): "rounding",
    ("5-3", "fast load_1_s"): "rounding",
    ("5-4", "slow K at 14 V"): "cut",
    ("5-4", "slow K at 16 V"): "cut",
    ("5-4", "fast K at 14 V"): "cut",
}


@pytest.mark.parametrize("key", list(LINES))
def test_every_printed_number_is_reached_or_explained(key: tuple[str, str]) -> None:
    assert LINES[key].agrees == EXPLAINED.get(key, "digits")


def test_every_line_of_the_four_tables_is_there() -> None:
    counts = {table: sum(key[0] == table for key in LINES) for table in ("5-2", "5-3", "5-4", "5-5")}
    assert counts == {"5-2": 24, "5-3": 17, "5-4": 8, "5-5": 4}


def test_the_averages_of_table_5_4_by_hand() -> None:
    slow = ((12 - 1.450) / 230.38 + (14 - 1.605) / 245.21 + (16 - 1.708) / 316.56) / 3
    fast = ((12 - 0.8 * 2.537) / 322.96 + (14 - 0.8 * 2.785) / 394.40 + (16 - 0.8 * 2.949) / 466.78) / 3
    assert f"{slow:.6f}" == "0.047163" and f"{fast:.6f}" == "0.029981"
    assert LINES["5-4", "slow K average"].ours == pytest.approx(slow, rel=1e-12)
    assert LINES["5-4", "fast K average"].ours == pytest.approx(fast, rel=1e-12)


def test_the_simulated_motor_is_found_again_to_a_hundred_thousandth() -> None:
    """From data, not from the printed function: L = 1/b1 and so on, against the motor that made the data."""
    motors = (("slow", (666.6666667, 6666.6667, 1343.33333, 16666.6667)), ("fast", (1e3, 1e4, 1010.0, 11250.0)))
    for mode, truth in motors:
        for name, value in zip(("b1", "b0", "a1", "a0"), truth, strict=True):
            assert LINES["5-2", f"{mode} {name} identified"].ours == pytest.approx(value, rel=1e-5)


def test_the_printed_gamma_would_not_fit() -> None:
    """With 2e-3 the inertia would be ten times the printed one (note on 5.3)."""
    inertia = float(load_file()["parameters"]["slow"]["inertia_kg_m2"])
    assert 2e-3 / LINES["5-2", "slow load_1_s"].ours == pytest.approx(10 * inertia, rel=1e-3)


def test_the_doubtful_row_is_told() -> None:
    assert "doubtful" in LINES["5-4", "slow K at 14 V"].remark
    assert not any(LINES["5-4", f"fast K at {volts} V"].remark for volts in (12, 14, 16))
    assert "3.728" in LINES["5-5", "slow time constant [s]"].remark


def test_a_wrong_number_would_be_seen() -> None:
    line = LINES["5-3", "slow resistance_ohm"]
    assert line._replace(ours=line.ours * 1.01, bounds=(0.96, 0.97)).agrees == "no"


def test_rounding_knows_digits() -> None:
    assert half_digit("1.12e-5") == pytest.approx(5e-8) and half_digit("4733") == 0.5
    assert rounds_to(0.0117, "0.0117") and not rounds_to(0.01176, "0.0117")
    assert cut_to(0.0505485, "0.050548") and not cut_to(0.050549, "0.050548")
    low, high = reachable(lambda a, b: a / b, ("1.0", "2.0"))
    assert math.isclose(low, 0.95 / 2.05) and math.isclose(high, 1.05 / 1.95)


def test_table_and_figures_hold_every_line() -> None:
    lines = list(LINES.values())
    assert len(as_table(lines).splitlines()) == len(lines) + 1
    flat = figures(lines)
    assert len(flat) == len(lines) + 4
    assert flat["lines_no"] == 0
