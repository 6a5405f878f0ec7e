"""Scenario files: values over ticks, and what is said about mistakes."""

from pathlib import Path

import numpy as np
import pytest

from hilplant.checked_yaml.problems import BenchError
from hilplant.failure import Failure
from hilplant.signals import INPUT_INDEX, INPUTS
from hilplant.simulation.scenario import Scenario, load_scenario

DEFAULTS = np.array([signal.default for signal in INPUTS])
STEP_NS = 1_000_000


def written(folder: Path, text: str) -> Scenario:
    path = folder / "scenario.yaml"
    path.write_text(text)
    return load_scenario(path)


def messages(folder: Path, text: str) -> list[str]:
    with pytest.raises(BenchError) as caught:
        written(folder, text)
    return [f"{problem.line}: {problem.text}" for problem in caught.value.problems]


def column(scenario: Scenario, name: str) -> np.ndarray:
    return scenario.input_rows(DEFAULTS, STEP_NS)[:, INPUT_INDEX[name]]


def test_values_hold_until_the_next_entry_and_the_bench_speaks_before_the_first(tmp_path: Path) -> None:
    scenario = written(
        tmp_path, "seconds: 0.01\nsignals:\n  relay_on: [[0.003, true], [0.005, false], [0.0081, true]]\n"
    )
    expected = [0, 0, 0, 1, 1, 0, 0, 0, 1, 1]
    assert column(scenario, "relay_on").tolist() == expected
    assert column(scenario, "supply_v").tolist() == [13.5] * 10


def test_a_ramp_starts_from_the_value_it_finds_and_reaches_its_own(tmp_path: Path) -> None:
    text = "seconds: 0.010\nsignals:\n  supply_v: [[0, 12], [0.002, {ramp_to: 8, seconds: 0.004}]]\n"
    expected = [12, 12, 12, 11, 10, 9, 8, 8, 8, 8]
    assert column(written(tmp_path, text), "supply_v").tolist() == expected


def test_an_entry_breaks_a_ramp_off_where_it_stands(tmp_path: Path) -> None:
    text = """
seconds: 0.008
signals:
  supply_v:
    - [0, 12]
    - [0.001, {ramp_to: 8, seconds: 0.004}]
    - [0.003, {ramp_to: 12, seconds: 0.002}]
"""
    expected = [12, 12, 11, 10, 11, 12, 12, 12]
    assert column(written(tmp_path, text), "supply_v").tolist() == expected


def test_a_ramp_may_outlast_the_scenario_and_an_entry_may_come_after_it(tmp_path: Path) -> None:
    text = "seconds: 0.003\nsignals:\n  supply_v: [[0, {ramp_to: 3.5, seconds: 0.01}], [9, 8]]\n"
    assert column(written(tmp_path, text), "supply_v").tolist() == pytest.approx([13.5, 12.5, 11.5])


def test_choices_go_by_name_and_the_initial_state_is_kept(tmp_path: Path) -> None:
    text = "seconds: 0.002\ninitial: {crank_angle_rad: 1.5}\nsignals:\n  screen: [[0.001, wet]]\n"
    scenario = written(tmp_path, text)
    assert column(scenario, "screen").tolist() == [0, 1]
    assert scenario.initial == {"crank_angle_rad": 1.5}


def test_a_number_with_names_goes_by_name_or_number_and_follows_a_ramp(tmp_path: Path) -> None:
    text = "seconds: 0.006\nsignals:\n  screen: [[0, dry], [0.001, {ramp_to: wet, seconds: 0.004}], [0.005, 0.3]]\n"
    assert column(written(tmp_path, text), "screen").tolist() == [0, 0, 0.25, 0.5, 0.75, 0.3]
    text = "seconds: 0.002\nsignals:\n  left_screen: [[0.001, tacky]]\n  right_screen: [[0, wet], [0.001, same]]\n"
    scenario = written(tmp_path, text)
    assert column(scenario, "left_screen").tolist() == [-1, 0.5]
    assert column(scenario, "right_screen").tolist() == [1, -1]


def test_no_ramp_begins_where_a_signal_takes_the_value_of_another(tmp_path: Path) -> None:
    text = "seconds: 1\nsignals:\n  left_screen: [[0.5, {ramp_to: wet, seconds: 0.1}]]\n"
    scenario = written(tmp_path, text)
    said = r"scenario\.yaml:3: left_screen is 'same' when its ramp at 0\.5 s begins; give it a value before"
    with pytest.raises(Failure, match=said):
        scenario.input_rows(DEFAULTS, STEP_NS)
    assert column(written(tmp_path, text.replace("[[0.5,", "[[0, dry], [0.5,")), "left_screen")[-1] == 1.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("seconds: 0", "1: seconds must be greater than 0, not 0"),
        ("second: 1\nseconds: 1", "1: unknown key 'second', did you mean 'seconds'?"),
        ("title: x", "1: key 'seconds' is missing"),
        ("seconds: 1\ninitial: 5", "2: initial must be a group of keys, not 5"),
        ("seconds: 1\nsignals:\n  supply_v: [[0, 12, 3]]", "3: entry 1 of supply_v must have at most 2 entries, not 3"),
        ("seconds: 1\ninitial: {crank_angle_rad: 7}", "2: crank_angle_rad must be less than"),
        (
            "seconds: 1\nsignals:\n  relay_of: []",
            "3: the plant has no input 'relay_of', did you mean 'relay_on'?",
        ),
        ("seconds: 1\nsignals:\n  relay_on: [[0, 2]]", "3: relay_on must be true or false, not 2"),
        ("seconds: 1\nsignals:\n  relay_on: [[0, on]]", "3: relay_on must be true or false, not 'on'"),
        (
            "seconds: 1\nsignals:\n  supply_v: [[0, 101]]",
            "3: supply_v must be a number from -16 to 100 V, not 101",
        ),
        (
            "seconds: 1\nsignals:\n  supply_v: [[0, true]]",
            "3: supply_v must be a number from -16 to 100 V, not true",
        ),
        (
            "seconds: 1\nsignals:\n  supply_v: [[0, .nan]]",
            "3: supply_v must be a number from -16 to 100 V, not nan",
        ),
        (
            "seconds: 1\nsignals:\n  screen: [[0, wett]]",
            "3: screen must be a number from 0 to 1 or one of dry, tacky, wet, not 'wett', did you mean 'wet'?",
        ),
        (
            "seconds: 1\nsignals:\n  screen: [[0, same]]",
            "3: screen must be a number from 0 to 1 or one of dry, tacky, wet, not 'same'",
        ),
        (
            "seconds: 1\nsignals:\n  left_screen: [[0, wet], [0.5, {ramp_to: same, seconds: 0.1}]]",
            "3: left_screen cannot ramp to 'same'; ramp to a number from 0 on, then say 'same'",
        ),
        (
            "seconds: 1\nsignals:\n  screen:\n    - [0, wet]\n    - [0, dry]",
            "5: time 0.0 s must come after 0.0 s",
        ),
        ("seconds: 1\nsignals:\n  screen: [[-1, wet]]", "3: time must be greater than or equal to 0, not -1"),
        ("seconds: 1\nsignals:\n  supply_v: [[0, {ramp_to: 1}]]", "3: key 'seconds' is missing"),
        ("seconds: 1\nsignals:\n  supply_v: [[0]]", "3: "),
        ("seconds: 1\nsignals:\n  relay_on: [[0, {ramp_to: 1, seconds: 1}]]", "3: relay_on is a flag"),
        ("seconds: 1\nsignals: 4", "2: signals must be a group of keys, not 4"),
        ("- 1", "1: "),
        ("seconds: [", "2: not YAML"),
    ],
)
def test_a_mistake_is_told_with_its_line_and_what_would_be_right(tmp_path: Path, text: str, message: str) -> None:
    found = messages(tmp_path, text + "\n")
    assert len(found) == 1
    assert found[0].startswith(message)


def test_all_mistakes_are_told_at_once(tmp_path: Path) -> None:
    text = "seconds: x\nsignals:\n  relay_on: [[0, 2]]\n  supply_v: [[0, 199], [1, true]]\n"
    assert [int(message.split(":")[0]) for message in messages(tmp_path, text)] == [1, 3, 4, 4]


def test_a_file_that_is_not_there_is_one_problem(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match=r"nowhere\.yaml:1: cannot be read: no such file"):
        load_scenario(tmp_path / "nowhere.yaml")
