"""What `hilplant list` shows: everything that is shipped, each parameter set with source and status."""

import json
from pathlib import Path

import pytest
import yaml

from hilplant.cli.main import app
from hilplant.control.catalogue import catalogue
from hilplant.failure import Failure
from hilplant.faults.catalogue import BY_NAME
from hilplant.inventory.controllers import CONTROLLERS
from hilplant.inventory.shipped_parts import FOLDERS, cited, kinds, listed
from hilplant.models.records import Motor
from hilplant.resources import shipped


@pytest.mark.parametrize("kind", FOLDERS)
def test_every_file_is_listed_with_what_it_says_of_itself(kind: str) -> None:
    files = {path.stem: yaml.safe_load(path.read_text()) for path in shipped("config", kind).glob("*.yaml")}
    parts = {part.name: part for part in listed(kind)}
    assert parts.keys() == files.keys()
    for name, part in parts.items():
        assert part.about and part.status and Path(part.file).is_file()
        if "status" in files[name]:
            assert part.status == files[name]["status"]
            assert part.source == " ".join(files[name]["source"].split())


def test_every_controller_of_the_catalogue_has_a_source() -> None:
    names = [part.name for part in listed("controllers")]
    assert CONTROLLERS.keys() == catalogue(Motor(*[1.0] * len(Motor._fields)), 0.001).keys()  # type: ignore[arg-type]
    assert names[: len(CONTROLLERS)] == list(CONTROLLERS)
    assert {"gentle_pi", "error_hebb_k_1"} <= set(names)
    assert all(part.source and part.status for part in listed("controllers"))


def test_every_fault_is_listed() -> None:
    assert [part.name for part in listed("faults")] == list(BY_NAME)


def test_the_title_of_the_thesis_is_shortened_and_the_table_kept() -> None:
    source = next(part.source for part in listed("motors") if part.name == "table_5_9")
    assert cited(source) == "Dooner (2016), Table 5-9; gear ratio: 5.4.2"


def test_a_kind_that_there_is_not_names_those_that_there_are() -> None:
    with pytest.raises(Failure, match="motors, linkages"):
        listed("engines")


def test_the_command_writes_what_the_room_returns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    app(["list", "motors", "--json", str(tmp_path / "motors.json")], standalone_mode=False)
    written = json.loads((tmp_path / "motors.json").read_text())
    assert written == {part.name: part._asdict() for part in listed("motors")}
    assert "table_5_9" in capsys.readouterr().out
    app(["list"], standalone_mode=False)
    shown = capsys.readouterr().out
    assert all(kind in shown for kind in kinds())
