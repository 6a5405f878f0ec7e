"""The catalogue, the course of a fault over time, and what it does to the parameters and to a run."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hilplant import BenchError, load_bench
from hilplant.failure import Failure
from hilplant.faults.bus_catalogue import BUS_FAULTS
from hilplant.faults.catalogue import BY_NAME, FAULTS, fault_named
from hilplant.faults.listing import fault_lines, table
from hilplant.faults.player import FaultPlayer
from hilplant.faults.timing import Inserted
from hilplant.models.records import PARAMETER_INDEX, STATE_INDEX
from hilplant.simulation.scenario import load_scenario

STEP_S = 1e-3


def middle(name: str) -> dict[str, float]:
    """Return values that change something: none of them is 0, or a factor of 1."""
    return {
        each.name: each.default if each.default is not None else each.minimum + 0.3 * (each.maximum - each.minimum)
        for each in BY_NAME[name].quantities
    }


def levels(inserted: Inserted, ticks: int) -> list[float]:
    player, seen = FaultPlayer([inserted], np.zeros(len(PARAMETER_INDEX)), STEP_S), []
    for tick in range(ticks):
        player.changes(tick)
        seen.append(player.courses[0].level)
    return seen


def test_every_change_of_every_fault_names_an_element_that_there_is() -> None:
    assert len(BY_NAME) == len(FAULTS) + len(BUS_FAULTS)
    for fault in FAULTS:
        for change in fault.changes:
            assert change.element in PARAMETER_INDEX, fault.name
            assert math.isfinite(change.value(middle(fault.name), STEP_S)), fault.name


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_a_fault_that_goes_leaves_the_parameters_as_they_were(fault: object) -> None:
    base = load_bench("default").parameter_row
    name = fault.name  # type: ignore[attr-defined]
    inserted = Inserted(fault_named(name), BY_NAME[name].complete(middle(name)), at=3, ticks=4)
    player, row = FaultPlayer([inserted], base, STEP_S), base.copy()
    for tick in range(10):
        for index, value in player.changes(tick).items():
            row[index] = value
        there = 3 <= tick < 7
        assert (player.present == (name,)) is there
        assert np.array_equal(row, base) is not there, tick


def test_several_faults_at_one_element_meet() -> None:
    base = load_bench("default").parameter_row
    worn = fault_named("resistance_53")
    both = [Inserted(worn, {"resistance_ohm": 0.5}), Inserted(worn, {"resistance_ohm": 0.25}, at=5)]
    player = FaultPlayer(both, base, STEP_S)
    at = PARAMETER_INDEX["wiring.wire_53.resistance_ohm"]
    assert player.changes(0)[at] == 0.5
    assert player.changes(5)[at] == 0.75


@pytest.mark.parametrize(
    ("course", "expected"),
    [
        ({"at": 2, "ticks": 3}, [0, 0, 1, 1, 1, 0, 0]),
        ({"at": 2}, [0, 0, 1, 1, 1, 1, 1]),
        ({"at": 1, "ramp": 4}, [0, 0.25, 0.5, 0.75, 1, 1, 1]),
        ({"at": 1, "ticks": 2, "pause": 1}, [0, 1, 1, 0, 1, 1, 0]),
        ({"at": 0, "probability": 0.0}, [0] * 7),
    ],
)
def test_the_course_of_a_fault(course: dict[str, float], expected: list[float]) -> None:
    assert levels(replace(Inserted(fault_named("supply_open"), {}), **course), 7) == expected  # type: ignore[arg-type]


@pytest.mark.parametrize("course", [{"at": 40}, {"at": 3, "ticks": 9, "pause": 5}, {"at": 2, "ramp": 6, "ticks": 20}])
def test_nothing_changes_before_the_tick_that_is_told(course: dict[str, int]) -> None:
    inserted = replace(Inserted(fault_named("supply_open"), {}), **course)  # type: ignore[arg-type]
    player, seen = FaultPlayer([inserted], np.zeros(len(PARAMETER_INDEX)), STEP_S), levels(inserted, 100)
    tick = 0
    while tick < 100:
        player.changes(tick)
        following = int(min(player.next_change(tick), 100))
        assert following > tick
        assert len(set(seen[tick:following])) == 1
        tick = following


def test_an_intermittent_fault_comes_as_often_as_its_probability_says_and_alike_in_each_run() -> None:
    inserted = Inserted(fault_named("supply_open"), {}, ticks=1, pause=1, probability=0.3, seed=5)
    once = levels(inserted, 4000)
    assert 520 < sum(once) < 680
    assert once == levels(inserted, 4000)
    assert once != levels(replace(inserted, seed=6), 4000)


SCENARIO = """
seconds: 0.3
signals: {relay_on: [[0, true]], screen: [[0, wet]]}
faults:
  - {fault: supply_open, at: 0.1, for: 0.05}
  - {fault: short_53_to_31, with: {resistance_ohm: 0.02}, when: {current_a: {above: 1.0}}, at: 0.2, for: 0.02}
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "faulty.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_faults_of_a_scenario_act_in_a_simulation(tmp_path: Path) -> None:
    from hilplant import simulate

    result = simulate("default", load_scenario(written(tmp_path, SCENARIO)))
    supply, current = result["supply_current_a"], result["current_a"]
    assert (supply[100:150] == 0.0).all() and (current[101:150] == 0.0).all()
    assert (current[50:100] > 0.5).all() and (current[160:200] > 0.5).all()
    began = int(np.argmax(supply > 400.0))
    assert began == 200  # the current of tick 199 was above 1 A
    assert (supply[200:220] > 400.0).all() and (supply[220:] < 50.0).all()


def test_a_run_whose_faults_never_come_has_the_bits_of_one_without(tmp_path: Path) -> None:
    from hilplant import simulate

    clean = simulate("default", load_scenario(written(tmp_path, SCENARIO.partition("faults:")[0])))
    never = SCENARIO.partition("faults:")[0] + "faults:\n  - {fault: supply_open, when: {current_a: {above: 400}}}\n"
    faulty = simulate("default", load_scenario(written(tmp_path, never)))
    assert np.array_equal(clean.outputs, faulty.outputs)


@pytest.mark.parametrize(
    ("entry", "told"),
    [
        ("{fault: suply_open}", "did you mean 'supply_open'"),
        ("{fault: resistance_53}", "needs resistance_ohm"),
        ("{fault: resistance_53, with: {ohm: 3}}", "has no quantity 'ohm'"),
        ("{fault: weak_magnets, with: {factor: 3.0}}", "between 0.1 and 1"),
        ("{fault: supply_open, when: {curent_a: {above: 3}}}", "did you mean 'current_a'"),
        ("{fault: supply_open, pause: 1}", "needs `for`"),
        ("{fault: supply_open, for: -1}", "for must be greater than 0"),
        ("{fault: supply_open, since: 3}", "unknown key 'since'"),
        ("{fault: supply_open, fro: 3}", "unknown key 'fro', did you mean 'for'?"),
        ("{fault: resistance_53, withs: {}}", "unknown key 'withs', did you mean 'with'?"),
        (
            "{fault: resistance_53, quantities: {}}",
            "unknown key 'quantities'; known: at, direction, fault, for",
        ),
    ],
)
def test_a_mistake_in_the_faults_is_told_with_its_line(tmp_path: Path, entry: str, told: str) -> None:
    path = written(tmp_path, f"seconds: 1\nfaults:\n  - {entry}\n")
    with pytest.raises(BenchError) as error:
        load_scenario(path)
    assert f"{path.name}:3: " in str(error.value) and told in str(error.value)


def test_one_fault_in_full_can_be_pasted_into_a_scenario(tmp_path: Path) -> None:
    for fault in BY_NAME.values():
        lines = fault_lines(fault.name)
        text = "seconds: 4\n" + "\n".join(
            line.removeprefix("  ") for line in lines[lines.index("in a scenario:") + 1 :]
        )
        assert len(load_scenario(written(tmp_path, text)).faults) == 1
    with pytest.raises(Failure, match="did you mean 'supply_open'"):
        fault_lines("supply_opens")


def test_the_documentation_holds_the_catalogue(root: Path = Path(__file__).parents[2]) -> None:
    text = (root / "docs" / "faults.md").read_text(encoding="utf-8")
    assert table() in text, "renew it: python -c 'from hilplant.faults.listing import table; print(table())'"


def test_no_state_is_named_by_a_fault() -> None:
    assert not {change.element for fault in FAULTS for change in fault.changes} & set(STATE_INDEX)
