"""Files that a user gives to the modelling page: readings of a motor, a CAN log with its database."""

from pathlib import Path

import pytest
from playwright.sync_api import Page, expect
from support.strangers_logs import COUNT, DBC, blf, blf_object, rows
from web.modelling import modelling, show

from hilplant.modelling.view import checked
from hilplant.motor_bench.motor_file import motor_from_readings
from hilplant.resources import shipped

pytestmark = pytest.mark.browser


@pytest.mark.parametrize("name", ["table_5_4_readings", "windings_12_coils"])
def test_readings_become_the_motor_of_the_model(page: Page, tmp_path: Path, name: str) -> None:
    readings = shipped("config", "measurements", f"{name}.yaml")
    expected = motor_from_readings(readings, tmp_path / "motor.yaml").values
    with modelling(page, tmp_path / "work") as session:
        page.set_input_files('[aria-label="readings or data sheet"]', readings)
        expect(page.locator("#standard-errors")).to_contain_text("constant_v_s")
        motor = checked(session.model).values["plant"]["motor"]
        for mode in ("slow", "fast"):
            for key in ("resistance_ohm", "inductance_henry", "constant_v_s"):
                assert motor[mode][key] == expected[f"{mode}_{key}"].n
        page.click("#undo")
        expect(page.locator("#standard-errors")).to_have_text("")


def test_readings_that_make_no_motor_say_why_and_change_nothing(page: Page, tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text("kind: bench\nname: half\n")
    with modelling(page, tmp_path / "work") as session:
        before = dict(session.model.texts)
        page.set_input_files('[aria-label="readings or data sheet"]', wrong)
        expect(page.locator("#said")).to_contain_text("wrong.yaml:1:")
        assert dict(session.model.texts) == before


def test_a_can_log_is_read_by_the_database_that_comes_with_it(page: Page, tmp_path: Path) -> None:
    (tmp_path / "rig.dbc").write_text(DBC)
    blf(tmp_path / "drive.blf", [blf_object(row) for row in rows(tmp_path / "rig.dbc")])
    with modelling(page, tmp_path / "work") as session:
        show(page, "identification")
        page.set_input_files('[aria-label="recordings"]', tmp_path / "drive.blf")
        page.click("tr[data-name='drive.blf'] >> text=look")
        expect(page.locator("#said")).to_contain_text("frames need a database")
        page.set_input_files('[aria-label="recordings"]', tmp_path / "rig.dbc")
        expect(page.locator('[aria-label="what reads CAN frames"]')).to_have_value("rig.dbc")
        expect(page.locator("#recordings tbody tr")).to_have_count(1)
        page.click("tr[data-name='drive.blf'] >> text=look")
        for role, column in {"voltage": "Motor.Volts", "current": "Motor.Amps", "park": "Switch.Park"}.items():
            page.select_option(f'[aria-label="column of {role}"]', column)
        expect(page.locator("section:has(#recordings) canvas")).to_have_count(3)
        expect(page.locator("section:has(#recordings)")).to_contain_text(f"{COUNT} samples")
        assert {path.name for path in session.recordings.iterdir()} == {"drive.blf", "rig.dbc"}
