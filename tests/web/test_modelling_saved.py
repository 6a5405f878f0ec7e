"""A wiper made on the page, saved, checked by the commands, run, opened again; and identified from a twin's CSV."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, expect
from web.modelling import enter, modelling, put_point, show

from hilplant.bench import load_bench
from hilplant.bench.verdict import verdict_on
from hilplant.identify.from_files import Request, figures, identify_files
from hilplant.identify.twin import Corruption, corrupted, played, thesis_conditions, write_csv
from hilplant.modelling.opening import open_model
from hilplant.modelling.view import checked
from hilplant.resources import shipped
from hilplant.simulation.run import simulate

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

#: A linkage of nine tenths of the one that is opened, typed in point by point.
POINTS = {
    "A": (0.04, 0.005), "B": (-0.2016, -0.0196), "C": (-0.2448, 0.0243),
    "D": (-0.2111, -0.0099), "E": (0.2093, -0.0158), "F": (0.1827, 0.0243),
}  # fmt: skip
LEFT_ARM = {"A": (-0.5, 0.01), "B": (-0.55, 0.04), "C": (-0.62, 0.04)}


def from_library(page: Page, part: str, name: str) -> None:
    with page.expect_response(lambda answer: answer.url.endswith("/api/part")) as answer:
        page.select_option(f'[aria-label="{part} from the library"]', name)
    assert answer.value.ok, answer.value.text()


def test_a_wiper_made_on_the_page_passes_the_commands_runs_and_comes_back(page: Page, tmp_path: Path) -> None:
    folder = tmp_path / "car"
    with modelling(page, tmp_path / "work") as session:
        from_library(page, "motor", "table_5_8")
        enter(page, "plant.motor.name", "my motor")
        enter(page, "plant.motor.gear_ratio", "60")
        show(page, "linkages")
        for letter, point in POINTS.items():
            put_point(page, "plant.linkage.points_m", letter, point)
        enter(page, "plant.screen.angle_rad", "-0.6")
        show(page, "arms")
        for letter, point in LEFT_ARM.items():
            put_point(page, "plant.linkage.left_arm.points_m", letter, point)
        show(page, "environment")
        from_library(page, "screen", "table_5_8")
        enter(page, "plant.screen.dry.mu_dry_1", "0.2")
        expect(page.locator("#verdict")).to_have_text("can run")
        page.click("#save")
        page.fill('[aria-label="folder"]', str(folder))
        page.click("#save-now")
        expect(page.locator("#where")).to_have_text(f"my_figure_8_3: {folder}")
        made = dict(session.model.texts)
    assert {path.name for path in folder.iterdir()} == {"bench.yaml", "motor.yaml", "linkage.yaml", "screen.yaml"}
    assert verdict_on(folder / "bench.yaml").problems == []
    for kind in ("bench", "motor", "linkage", "screen"):
        schema = shipped("config", "schemas", f"{kind}-1.json")
        command = [sys.executable, "-m", "check_jsonschema", "--schemafile", schema, folder / f"{kind}.yaml"]
        subprocess.run(command, check=True, capture_output=True)
    bench = load_bench(folder / "bench.yaml")
    assert bench.parameters.motor.gear_ratio == 60
    assert bench.plant.mechanics.written.points_m["E"][:2] == [0.2093, -0.0158]
    turned = np.unwrap(simulate(bench, "slow_fast_park")["crank_angle_rad"])
    assert turned[-1] - turned[0] > 2.0 * np.pi
    with modelling(page, tmp_path / "again", folder / "bench.yaml") as session:
        assert dict(session.model.texts) == made
        assert page.input_value('[aria-label="plant.motor.gear_ratio"]') == "60"


SETTINGS = {"generations": 6, "population": 24, "seed": 3}


@pytest.fixture(scope="module")
def twin(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two recordings of the default bench's own twin, as a rig would have left them."""
    folder, bench = tmp_path_factory.mktemp("rig"), load_bench("default")
    for name, condition in zip(("slow_dry", "fast_wet"), thesis_conditions((11.0, 13.0, 16.0)), strict=True):
        write_csv(folder / f"{name}.csv", corrupted(played(bench, condition), Corruption(), 0.001, 11))
    return folder


@pytest.fixture(scope="module")
def expected(twin: Path) -> dict[str, Any]:
    """What the command finds in the same recordings, from the bench that the page has opened."""
    out = twin / "commanded"
    bench = open_model("default").written_to(out / "bench")
    data = f"{twin / 'fast_wet.csv'}@wet", f"{twin / 'slow_dry.csv'}@dry"
    return figures(identify_files(Request(data, str(bench), out / "car.yaml", date="2026-01-01", **SETTINGS)).found)


def start(page: Page, twin: Path) -> None:
    show(page, "identification")
    page.set_input_files('[aria-label="recordings"]', [twin / "slow_dry.csv", twin / "fast_wet.csv"])
    page.wait_for_selector("#recordings tr[data-name='slow_dry.csv']")
    for key, value in SETTINGS.items():
        page.fill(f'[aria-label="{key}"]', str(value))
    page.click('button[data-stages="1,2,3"]')


def found_on(page: Page) -> dict[str, float]:
    page.wait_for_selector("#identified tr[data-name]", timeout=600_000)
    rows = page.locator("#identified tr[data-name]").all()
    return {str(row.get_attribute("data-name")): float(str(row.get_attribute("data-found"))) for row in rows}


def test_identification_on_the_page_is_the_commands_and_is_accepted_into_the_panels(
    page: Page, tmp_path: Path, twin: Path, expected: dict[str, Any]
) -> None:
    with modelling(page, tmp_path / "work", "default") as session:
        before = dict(session.model.texts)
        start(page, twin)
        found = found_on(page)
        assert found == {name: pytest.approx(expected[name], rel=1e-12) for name in found}
        assert found["slow_resistance_ohm"] == pytest.approx(1.2368, rel=0.03)  # the twin's own
        page.click("#accept")
        expect(page.locator("#identified")).to_contain_text("Taken into the panels")
        bench = checked(session.model).bench
        assert bench is not None
        assert bench.parameters.motor.slow.resistance_ohm == found["slow_resistance_ohm"]
        assert bench.parameters.load.left_blade.force_n == found["force_n"]
        assert bench.plant.motor.status == "identified"
        for name in ("motor.yaml", "screen.yaml"):
            assert [line for line in before[name].splitlines() if line.startswith("#")] == [
                line for line in session.model.texts[name].splitlines() if line.startswith("#")
            ]
        page.click("#undo")
        expect(page.locator("#where")).to_contain_text("my_default")
        assert dict(session.model.texts) == before


def test_a_stopped_identification_goes_on_to_the_same_result(
    page: Page, tmp_path: Path, twin: Path, expected: dict[str, Any]
) -> None:
    with modelling(page, tmp_path / "work", "default") as session:
        start(page, twin)
        job = page.locator("div[data-state]")
        expect(job.locator("[role=status]")).to_contain_text("evaluations", timeout=600_000)
        job.locator("text=Stop").click()
        expect(job).to_have_attribute("data-state", "stopped", timeout=60_000)
        journal = session.work / "identified" / "identified.yaml.journal"
        assert journal.exists()
        with np.load(journal) as seen:
            known = len(seen["lengths"])
        page.click("#resume")
        found = found_on(page)
        assert found == {name: pytest.approx(expected[name], rel=1e-12) for name in found}
        assert known > 0
        answer = json.loads(json.dumps(session.jobs.state["answer"]))
        assert answer["figures"]["search_evaluations"] == expected["search_evaluations"]
