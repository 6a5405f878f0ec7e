"""A bench may be a path, the text itself, or a description that a program made; all three are one bench."""

import json
from pathlib import Path

import pytest

from hilplant.bench import BenchError, check_bench, load_bench
from hilplant.bench.description import BenchDescription

TEXT = "extends: default.yaml\nname: mine\nplant:\n  load: {model: none}\ninputs: {supply_v: 12}\n"


def test_text_is_the_bench_that_a_file_with_it_is(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(TEXT)
    from_text, from_file = load_bench(TEXT), load_bench(path)
    assert from_text.parameter_row.tobytes() == from_file.parameter_row.tobytes()
    assert from_text.input_row.tolist() == from_file.input_row.tolist()
    assert TEXT in from_text.sources.values()


@pytest.mark.parametrize("name", ["default", "depressed", "network", "networks", "linkage_alone_polynomial"])
def test_a_description_has_all_that_its_files_say(name: str) -> None:
    """It is built again from its own JSON, without any of the files but the bus database."""
    bench = load_bench(name)
    data = json.loads(bench.description.model_dump_json(exclude_unset=True))
    again = load_bench(BenchDescription.model_validate_json(json.dumps(data)))
    assert again.parameter_row.tobytes() == bench.parameter_row.tobytes()
    assert again.tables.tobytes() == bench.tables.tobytes()
    assert again.state_row.tobytes() == bench.state_row.tobytes()
    assert [message.name for message in again.send] == [message.name for message in bench.send]
    assert json.loads(next(iter(again.sources.values()))) == data


def test_a_mistake_in_text_has_its_line() -> None:
    (problem,) = check_bench(f"{TEXT}step_s: 1\n")
    assert str(problem) == "(text):6: step_s must be less than or equal to 0.02, not 1"


def test_a_mistake_in_a_description_has_its_path() -> None:
    description = load_bench(TEXT).description.model_copy(update={"step_s": 1.5e-10})
    (problem,) = check_bench(description)
    assert problem.text == "step_s: step_s must be a whole number of nanoseconds, not 1.5e-10"
    with pytest.raises(BenchError, match="step_s must be a whole number"):
        load_bench(description)


def test_a_part_may_stand_in_the_bench_itself() -> None:
    screen = load_bench().description.plant.screen
    assert screen is not None
    written = screen.model_dump_json(exclude_unset=True)
    inline = load_bench(f"extends: default.yaml\nname: mine\nplant:\n  screen: {written}\n")
    assert inline.parameter_row.tobytes() == load_bench().parameter_row.tobytes()


def test_a_mistake_in_one_part_hides_none_in_another() -> None:
    """One of each: the description, a part's file, the mechanics, the database."""
    text = (
        "extends: default.yaml\nname: mine\nplant:\n  motor: nowhere.yaml\n"
        "  blades: {left: {force_n: 7, area_m2: 1, lift: [[90, 1], [120, 1]]}, right: {force_n: 7}}\n"
        "  park_switch: {park_angle_deg: 400, window_deg: 9}\n"
        "bus:\n  receive:\n    RelayCommand: {signals: {RelayOn: {signal: relay_on, scal: 2}, RelayFst: relay_fast}}\n"
        "loop: {priority: 100}\n"
    )
    assert [problem.line for problem in check_bench(text)] == [4, 5, 6, 9, 9, 10]
