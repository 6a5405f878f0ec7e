"""The page's plots, logs, layouts and scenarios on a plant that runs."""

import csv
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect
from web.chromium import page_of
from web.plant_with_page import PlantWithPage, control, plant_with_page, shown, until
from web.served import served

from hilplant.bench import load_bench
from hilplant.bus.database import database_among
from hilplant.operator_page.description import describe
from hilplant.operator_page.recorded import RecordedRows, RecordedScreen
from hilplant.operator_page.server import operator_page
from hilplant.recording.reader import read_recording
from hilplant.recording.replay import replay
from hilplant.recording.span import EVERYTHING
from hilplant.web.access import Access

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]


@pytest.fixture(scope="module")
def plant(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PlantWithPage]:
    with plant_with_page(tmp_path_factory.mktemp("page") / "logs") as running:
        yield running


@pytest.fixture(scope="module")
def page(browser: Browser, plant: PlantWithPage) -> Iterator[Page]:
    with shown(browser, plant) as opened:
        yield opened


def frames_of(path: Path) -> list[dict[str, Any]]:
    tables = read_recording(path).table(["frames"]).column(0).to_pylist()
    return [frame for frames in tables for frame in frames]


def test_a_table_begins_before_its_trigger_and_has_every_tick(page: Page, plant: PlantWithPage) -> None:
    page.locator("#log-file").fill("edge.csv")
    page.locator("#log-way").select_option("rises")
    page.locator("#log-signal").select_option("in.supply_v")
    page.locator("#log-level").fill("14")
    page.locator("#log-before").fill("0.5")
    page.locator("#log-seconds").fill("0.25")
    page.locator("#log-signals").select_option(["in.supply_v", "current_a", "park_contact"])
    page.locator("#log-start").click()
    expect(page.locator("#log-state")).to_have_text("waits for its trigger")
    control(page, "supply_v").locator("input").fill("15")
    control(page, "supply_v").locator("input").press("Enter")
    expect(page.locator("#log-state")).to_have_text("whole")
    with (plant.logs / "edge.csv").open() as file:
        rows = list(csv.DictReader(file))
    times = np.array([float(row["time_s"]) for row in rows])
    above = np.array([float(row["in_supply_v"]) for row in rows]) > 14.0
    edge = int(np.argmax(above))
    assert above.any() and not above[:edge].any() and above[edge:].all()
    assert times[edge] - times[0] == pytest.approx(0.5, abs=0.02)
    assert times[-1] - times[edge] == pytest.approx(0.25, abs=0.02)
    assert all(later > before for before, later in pairwise(times))
    assert set(rows[0]) == {"time_s", "in_supply_v", "current_a", "park_contact"}


@pytest.fixture(scope="module")
def drive(page: Page, plant: PlantWithPage) -> Path:
    """A recording that was started on the page: off, slow, off."""
    page.locator("#log-file").fill("drive.hilrec")
    page.locator("#log-start").click()
    expect(page.locator("#log-state")).to_have_text("recording")
    expect(page.locator("#recording")).to_have_text("recording complete")
    page.locator("#stalk-slow").click()
    expect(page.locator("#stalk-state")).to_have_text("ECU: slow")
    until(lambda: page.evaluate("hilplant.session.samples.value('current_a')") > 0.5)
    page.locator("#stalk-off").click()
    page.locator("#log-stop").click()
    expect(page.locator("#log-state")).not_to_have_text("recording")
    return plant.logs / "drive.hilrec"


def test_a_recording_of_the_page_replays_bit_for_bit(drive: Path) -> None:
    assert replay(drive).equal
    assert np.nanmax(read_recording(drive).table(["out.current_a"]).column(0).to_numpy()) > 0.5


def test_a_recording_shows_frames_ecu_and_events_at_the_cursor(browser: Browser, drive: Path) -> None:
    rows, bench, access = RecordedRows(drive, EVERYTHING), load_bench("virtual"), Access()
    current = rows.rows[:, rows.place("current_a")]
    turning_s = float(rows.times_s[int(np.argmax(current > 0.5))])
    recorded = operator_page(describe(bench), RecordedScreen(drive, rows, bench, access).serve)
    with served(recorded, access) as url, page_of(browser) as page:
        page.goto(f"{url}#token={access.token}")
        moment = page.locator("#moment")
        expect(moment).to_be_visible()

        def show(time_s: float) -> None:
            moment.evaluate("(node, at) => { node.value = at; node.dispatchEvent(new Event('input')); }", time_s)

        show(turning_s + 0.2)
        page.locator("#tab-frames").click()
        values = page.locator("#frames tr[data-message=MotorStatus] .values")
        expect(values).to_contain_text("MotorCurrent")
        until_ns = (turning_s + 0.2) * 1e9
        sent = [each for each in frames_of(drive) if each["identifier"] == 0x200 and each["time_ns"] <= until_ns]
        database = database_among(bench.sources)
        assert database is not None
        decoded = database.get_message_by_frame_id(0x200).decode(sent[-1]["data"])
        expect(values).to_contain_text(f"MotorCurrent {decoded['MotorCurrent']:.5g}")
        expect(page.locator("#frames tr[data-message=MotorStatus] td").nth(5)).to_have_text(str(len(sent)))
        page.locator("#tab-ecu").click()
        status = database.get_message_by_name("EcuStatus")
        told = [each for each in frames_of(drive) if each["identifier"] == status.frame_id]
        state = status.decode([each for each in told if each["time_ns"] <= until_ns][-1]["data"])["EcuState"]
        assert str(state) in {"Slow", "Wait"}  # the stalk was switched off as soon as the motor turned
        expect(page.locator("#ecu-live")).to_have_text(str(state).lower())
        page.locator("#tab-events").click()
        begun = page.locator("#events li", has_text="hand recording").last
        begun.locator("button").click()
        expect(page.locator("#moment-told")).to_contain_text(begun.locator("button").inner_text().split()[0])


@pytest.mark.parametrize("name", ["../outside.csv", "/tmp/outside.csv", "a/b.csv", "..", ".hidden.csv", "edge.txt", ""])
def test_nothing_is_written_outside_the_folder_of_logs(page: Page, plant: PlantWithPage, name: str) -> None:
    before = sorted(plant.logs.parent.rglob("*"))
    page.locator("#log-file").fill(name)
    page.locator("#log-start").click()
    expect(page.locator("#note")).to_contain_text("refused")
    assert sorted(plant.logs.parent.rglob("*")) == [*before] or plant.logs not in before


def test_pause_zoom_and_two_cursors_with_their_difference(page: Page) -> None:
    page.locator("#stalk-slow").click()
    page.locator("#window").select_option("2")
    until(lambda: page.evaluate("hilplant.session.samples.end") > 200)
    page.locator("#pause").click()
    range_s = page.evaluate("hilplant.plots.range()")
    until(lambda: page.evaluate("hilplant.plots.frozen.data !== null"))
    assert page.evaluate("hilplant.plots.range()") == range_s
    box = page.locator(".u-over").first.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 40)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 40, steps=4)
    page.mouse.up()
    first, last = page.evaluate("hilplant.plots.range()")
    assert last - first == pytest.approx(0.2 * (range_s[1] - range_s[0]), rel=0.1)
    until(lambda: page.evaluate("hilplant.plots.frozen.data !== null"))
    inside = page.evaluate("hilplant.plots.frozen.data.data[0].length")
    assert inside == pytest.approx((last - first) * 1.04 * 1000, abs=12)  # each tick
    page.locator("#cursors").click()
    page.mouse.click(box["x"] + 0.25 * box["width"], box["y"] + 60)
    page.keyboard.down("Shift")
    page.mouse.click(box["x"] + 0.75 * box["width"], box["y"] + 60)
    page.keyboard.up("Shift")
    expect(page.locator("#cursor-note")).to_contain_text("Δt")
    cursors = page.evaluate("hilplant.plots.cursors")
    assert cursors["B"] - cursors["A"] == pytest.approx(0.5 * (last - first), rel=0.02)
    expect(page.locator(".legend").first).to_contain_text("Δ")
    page.locator("#pause").click()
    expect(page.locator("#pause")).to_have_text("Pause")
    page.locator("#stalk-off").click()


def test_signals_are_chosen_and_a_layout_comes_back(page: Page) -> None:
    page.get_by_label("add a signal").first.select_option("load_torque_n_m")
    until(lambda: "load_torque_n_m" in page.evaluate("hilplant.session.samples.names"))
    page.on("dialog", lambda dialog: dialog.accept("mine"))
    page.locator("#rate").select_option("60")
    page.locator("#layout-save").click()
    page.locator("#rate").select_option("32")
    page.get_by_label("remove load_torque_n_m").click()
    until(lambda: "load_torque_n_m" not in page.evaluate("hilplant.session.chosen"))
    page.locator("#layout").select_option("mine")
    until(lambda: "load_torque_n_m" in page.evaluate("hilplant.session.samples.names"))
    assert page.evaluate("hilplant.session.rateHz") == 60
    page.reload()
    expect(page.locator(".legend").first).to_contain_text("load_torque_n_m")
    expect(page.locator("#rate")).to_have_value("60")


def test_a_hidden_page_is_sent_nothing(page: Page) -> None:
    page.evaluate("""() => {
        Object.defineProperty(document, "hidden", { get: () => window.pretend ?? false });
        window.heard = 0; hilplant.session.link.addEventListener("data", () => { window.heard += 1; });
        window.pretend = true; document.dispatchEvent(new Event("visibilitychange"));
    }""")
    page.wait_for_timeout(2000)  # what was on its way
    heard, draws = page.evaluate("[window.heard, hilplant.plots.stats.draws]")
    page.wait_for_timeout(1500)
    assert page.evaluate("[window.heard, hilplant.plots.stats.draws]") == [heard, draws]
    page.evaluate("() => { window.pretend = false; document.dispatchEvent(new Event('visibilitychange')); }")
    until(lambda: page.evaluate("window.heard") > heard + 5)


def test_a_scenario_runs_to_its_end_with_verdicts(page: Page) -> None:
    page.locator("#tab-scenarios").click()
    page.locator("#scenario").select_option("02_slow")
    page.locator("#scenario-start").click()
    expect(page.locator("#scenario-told")).to_contain_text("running")
    expect(page.locator("#scenario-told")).to_contain_text(", over", timeout=60_000)
    rulings = page.locator("#verdicts .tag").all_inner_texts()
    assert rulings and set(rulings) <= {"pass", "later", "inconclusive"}, rulings
    page.locator("#scenario-start").click()
    expect(page.locator("#scenario-told")).to_contain_text("running")
    page.locator("#scenario-stop").click()
    expect(page.locator("#scenario-told")).to_contain_text("stopped")
    page.locator("#stalk-off").click()
