"""A bench that is edited: the change stands where the value stood, comments stay, shipped files are never written."""

import io
import zipfile
from pathlib import Path
from typing import Any

import pytest

from hilplant.bench import load_bench
from hilplant.checked_yaml.editing import EditError
from hilplant.checked_yaml.yaml_reader import read_text
from hilplant.failure import Failure
from hilplant.modelling.model_files import ModelFiles
from hilplant.modelling.opening import open_model, with_library_part
from hilplant.modelling.session import ModellingSession
from hilplant.modelling.view import checked
from hilplant.resources import shipped

FIGURE_8_3 = {"torque": 63, "points": ("O", "A", "B", "C", "D", "E", "F"), "gamma": -0.57}

#: Where a value stands, another value for it, and the file in which it must then be.
EDITS: list[tuple[tuple[str, ...], Any, str]] = [
    (("plant", "motor", "gear_ratio"), 70, "motor.yaml"),
    (("plant", "motor", "slow", "resistance_ohm"), 1.3, "motor.yaml"),
    (("plant", "linkage", "points_m", "A"), [0.0446, 0.0055, 0.0], "linkage.yaml"),
    (("plant", "linkage", "masses_kg", "coupler"), 0.4, "linkage.yaml"),
    (("plant", "linkage", "left_arm", "mass_kg"), 0.45, "linkage.yaml"),
    (("plant", "screen", "angle_rad"), -0.6, "screen.yaml"),
    (("plant", "screen", "dry", "mu_dry_1"), 0.3, "screen.yaml"),
    (("plant", "blades", "left", "force_n"), 8.0, "bench.yaml"),
    (("plant", "park_switch", "window_deg"), 20.0, "bench.yaml"),
    (("inputs", "supply_v"), 12.0, "bench.yaml"),
    (("inputs", "vehicle_speed_m_s"), 20.0, "bench.yaml"),
    (("name",), "my wiper", "bench.yaml"),
]


def at(model: ModelFiles, location: tuple[str, ...]) -> Any:
    value: Any = checked(model).values
    for step in location:
        value = value[step]
    return value


@pytest.fixture(scope="module")
def opened() -> ModelFiles:
    return open_model("default")


def test_the_printed_defaults_of_figure_8_3_are_opened_when_nothing_is_named() -> None:
    found = checked(open_model())
    assert found.bench is not None
    plant = found.values["plant"]
    assert plant["motor"]["gear_ratio"] == FIGURE_8_3["torque"]
    assert tuple(plant["linkage"]["points_m"]) == FIGURE_8_3["points"]
    assert plant["screen"]["angle_rad"] == FIGURE_8_3["gamma"]
    assert plant["linkage"]["points_m"]["B"][:2] == [-0.2240, -0.0218]


@pytest.mark.parametrize(
    ("location", "value", "file"), EDITS, ids=lambda each: ".".join(each) if isinstance(each, tuple) else ""
)
def test_a_value_is_changed_where_it_stands(
    opened: ModelFiles, location: tuple[str, ...], value: Any, file: str
) -> None:
    changed = opened.with_value(location, value)
    assert [name for name, text in changed.texts.items() if text != opened.texts[name]] == [file]
    found = checked(changed)
    assert found.bench is not None, found.problems
    assert at(changed, location) == value


def test_all_edits_after_one_another_keep_every_comment_and_give_the_bench_that_was_meant(opened: ModelFiles) -> None:
    changed = opened
    for location, value, _ in EDITS:
        changed = changed.with_value(location, value)
    for name, text in opened.texts.items():
        comments = [line.partition("#")[2] for line in text.splitlines() if "#" in line]
        assert [line.partition("#")[2] for line in changed.texts[name].splitlines() if "#" in line] == comments
    bench = checked(changed).bench
    assert bench is not None
    assert bench.parameters.motor.gear_ratio == 70
    assert bench.parameters.load.left_blade.force_n == 8.0
    assert bench.parameters.load.right_blade.force_n == 7.615
    assert bench.plant.mechanics.written.points_m["A"] == [0.0446, 0.0055, 0.0]


@pytest.mark.parametrize("bench", sorted(path.stem for path in shipped("config", "benches").glob("*.yaml")))
def test_every_shipped_bench_is_opened_as_the_same_bench(bench: str) -> None:
    found = checked(open_model(bench))
    assert found.bench is not None, found.problems
    original = load_bench(bench)
    assert (found.bench.parameter_row == original.parameter_row).all()
    assert (found.bench.tables == original.tables).all()


def test_what_was_saved_is_the_same_when_it_is_opened_again(opened: ModelFiles, tmp_path: Path) -> None:
    changed = opened.with_value(("plant", "blades", "left", "force_n"), 8.0)
    saved = changed.saved(tmp_path / "wiper")
    assert saved.is_saved
    again = open_model(tmp_path / "wiper" / "bench.yaml")
    assert again.texts == changed.texts
    assert again.is_saved
    assert (load_bench(tmp_path / "wiper" / "bench.yaml").parameter_row == checked(changed).bench.parameter_row).all()  # type: ignore[union-attr]


def test_shipped_files_are_never_written(opened: ModelFiles) -> None:
    for folder in (shipped("config"), shipped("config", "benches"), shipped("dbc")):
        with pytest.raises(Failure, match="shipped files"):
            opened.saved(folder)
        with pytest.raises(Failure, match="shipped files"):
            opened.saved(folder, overwrite=True)


def test_a_file_that_somebody_else_changed_is_not_overwritten(opened: ModelFiles, tmp_path: Path) -> None:
    saved = opened.saved(tmp_path)
    changed = saved.with_value(("name",), "other")
    (tmp_path / "motor.yaml").write_text("name: by hand\n")
    with pytest.raises(Failure, match=r"motor\.yaml: is there already"):
        changed.saved(tmp_path)
    assert (tmp_path / "motor.yaml").read_text() == "name: by hand\n"
    assert "other" in changed.saved(tmp_path, overwrite=True).texts["bench.yaml"]


def test_a_bench_of_the_user_keeps_its_files_and_their_names(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "my_motor.yaml").write_text(shipped("config", "motors", "table_5_8.yaml").read_text())
    (tmp_path / "base.yaml").write_text("extends: default.yaml\nname: base\n")
    text = "# mine\nextends: base.yaml\nname: car\nplant:\n  motor: parts/my_motor.yaml # measured\n"
    (tmp_path / "car.yaml").write_text(text)
    model = open_model(tmp_path / "car.yaml")
    assert set(model.texts) == {"car.yaml", "parts/my_motor.yaml", "linkage.yaml", "screen.yaml"}
    assert set(model.others) == {"base.yaml"}
    assert model.texts["car.yaml"].startswith(text)
    assert (tmp_path / "car.yaml").read_text() == text
    changed = model.with_value(("plant", "motor", "gear_ratio"), 65)
    assert "gear_ratio: 65" in changed.texts["parts/my_motor.yaml"]
    assert at(changed, ("plant", "motor", "gear_ratio")) == 65


def test_a_part_that_stands_in_the_bench_is_changed_there(tmp_path: Path) -> None:
    motor = read_text(shipped("config", "motors", "table_5_8.yaml").read_text(), "m").data
    path = tmp_path / "one.yaml"
    path.write_text(f"extends: default.yaml\nname: one\nplant:\n  motor: {motor!r}\n".replace("'", '"'))
    changed = open_model(path).with_value(("plant", "motor", "gear_ratio"), 71)
    assert at(changed, ("plant", "motor", "gear_ratio")) == 71
    assert '"gear_ratio": 71' in changed.texts["one.yaml"]


def test_a_problem_names_the_file_of_the_model_its_line_and_the_keys(opened: ModelFiles) -> None:
    found = checked(opened.with_value(("plant", "motor", "slow", "resistance_ohm"), -1))
    (problem,) = found.problems
    assert (problem.file, problem.location) == ("motor.yaml", ("plant", "motor", "slow", "resistance_ohm"))
    lines = opened.texts["motor.yaml"].splitlines()
    assert lines[problem.line - 1].startswith("slow:")


def test_text_that_is_broken_is_a_problem_and_no_error(opened: ModelFiles) -> None:
    found = checked(opened.with_text("motor.yaml", "name: [\n"))
    assert found.bench is None
    assert {problem.file for problem in found.problems} == {"motor.yaml"}
    with pytest.raises(EditError):
        opened.with_text("motor.yaml", "name: [\n").with_value(("plant", "motor", "gear_ratio"), 3)


def test_a_part_of_the_library_takes_the_place_of_another(opened: ModelFiles) -> None:
    changed = with_library_part(opened, "linkage", "lhd_centre_driven")
    assert changed.texts["linkage.yaml"] == shipped("config", "linkages", "lhd_centre_driven.yaml").read_text()
    assert at(changed, ("plant", "linkage", "kind")) == "centre_driven"
    with pytest.raises(Failure, match="none of the shipped"):
        with_library_part(opened, "motor", "../benches/default")


def test_the_zip_holds_every_file(opened: ModelFiles) -> None:
    with zipfile.ZipFile(io.BytesIO(opened.zipped())) as archive:
        assert {name: archive.read(name).decode() for name in archive.namelist()} == dict(opened.texts)


def test_changes_are_taken_back_and_made_again(opened: ModelFiles, tmp_path: Path) -> None:
    session = ModellingSession(opened, tmp_path)
    session.change(0, lambda model: model.with_value(("name",), "one"))
    session.change(1, lambda model: model.with_value(("name",), "two"))
    with pytest.raises(Failure, match="another window"):
        session.change(1, lambda model: model)
    session.step(-1)
    assert session.shown()["values"]["name"] == "one"
    session.step(1)
    assert session.shown()["values"]["name"] == "two"
    session.step(-5)
    assert session.shown()["values"]["name"] == "my_default"
