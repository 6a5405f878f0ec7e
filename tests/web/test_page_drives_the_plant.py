"""Each control of the operator's page acts on a plant that runs, and shows what the plant confirms."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect
from web.plant_with_page import PlantWithPage, confirmed, control, owner, plant_with_page, shown, until

from hilplant.declaration import Signal
from hilplant.signals import INPUTS

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]


@pytest.fixture(scope="module")
def plant(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PlantWithPage]:
    with plant_with_page(tmp_path_factory.mktemp("page") / "logs") as running:
        yield running


@pytest.fixture(scope="module")
def page(browser: Browser, plant: PlantWithPage) -> Iterator[Page]:
    with shown(browser, plant) as opened:
        yield opened


def output(page: Page, name: str) -> float:
    return float(page.evaluate(f"hilplant.session.samples.value('out.{name}')"))


def test_the_stalk_moves_the_wiper_and_off_parks_it(page: Page) -> None:
    page.locator("#stalk-fast").click()
    expect(page.locator("#stalk-state")).to_have_text("ECU: fast")
    expect(confirmed(page, "relay_fast")).to_have_text("on")
    expect(owner(page, "relay_on")).to_have_text("bus")
    until(lambda: output(page, "crank_speed_rad_s") > 3.0)
    blade = page.locator("svg.wiper polyline").first
    before = blade.get_attribute("points")
    until(lambda: blade.get_attribute("points") != before)
    page.keyboard.press("s")
    expect(page.locator("#stalk-state")).to_have_text("ECU: slow")
    page.locator("#stalk-automatic").click()  # a rain sensor that is silent means intermittent
    expect(page.locator("#stalk-state")).to_have_text("ECU: pause_1")
    expect(page.locator("#stalk-automatic")).to_have_attribute("aria-pressed", "true")
    page.locator("#stalk-intermittent3").click()
    expect(page.locator("#stalk-automatic")).to_have_attribute("aria-pressed", "false")
    expect(page.locator("#stalk-state")).to_have_text("ECU: pause_3")
    page.keyboard.press("o")
    expect(page.locator("#stalk-state")).to_have_text("ECU: off")
    until(lambda: output(page, "park_contact") == 1.0 and output(page, "crank_speed_rad_s") == 0.0)
    page.locator("#stalk-flick").click()
    expect(page.locator("#events")).to_contain_text("ecu state off -> flick")
    expect(page.locator("#stalk-state")).to_have_text("ECU: off")
    page.locator("#stalk-wash").click()
    expect(page.locator("#events")).to_contain_text("ecu state washing -> wash_wipes")
    expect(page.locator("#stalk-state")).to_have_text("ECU: off")


def other_value(signal: Signal) -> float:
    """Return a permitted value that is not the default; small, so that the wiper still moves."""
    if signal.kind == "flag":
        return 1.0 - signal.default
    if signal.kind == "choice" or len(signal.names) > 1:
        values = [value for _, value in signal.names] or [float(index) for index in range(len(signal.choices))]
        return next(value for value in values if value != signal.default)
    return min(signal.maximum, signal.default + 0.5)


@pytest.mark.parametrize("signal", INPUTS, ids=lambda signal: signal.name)
def test_each_input_of_the_declaration_has_a_control_that_holds_and_releases(page: Page, signal: Signal) -> None:
    value, there = other_value(signal), control(page, signal.name)
    if signal.kind == "flag":
        there.get_by_role("button", name="on" if value else "off", exact=True).click()
    elif signal.kind == "choice" or len(signal.names) > 1:
        there.locator("select").select_option(str(int(value) if value == int(value) else value))
    else:
        there.locator("input").fill(str(value))
        there.locator("input").press("Enter")
    expect(owner(page, signal.name)).to_have_text("hand")
    until(lambda: page.evaluate(f"hilplant.session.samples.value('in.{signal.name}')") == pytest.approx(value))
    expect(there.locator(".pending")).to_be_hidden()
    expect(page.locator("#note")).to_contain_text("applied at tick")
    there.locator(".release").click()
    expect(owner(page, signal.name)).not_to_have_text("hand")


def test_a_value_that_the_plant_refuses_is_not_shown_as_if_it_were_there(page: Page) -> None:
    control(page, "supply_v").locator("input").fill("500")
    control(page, "supply_v").locator("input").press("Enter")
    expect(page.locator("#note")).to_contain_text("refused")
    expect(confirmed(page, "supply_v")).to_have_text("13.50 V")


def test_main_power_off_is_an_open_circuit(page: Page) -> None:
    page.locator("#power-off").click()
    expect(page.locator("#power-state")).to_contain_text("open circuit")
    until(lambda: output(page, "supply_current_a") == 0.0)
    page.locator("#power-on").click()
    expect(page.locator("#power-state")).to_contain_text("13.50 V")


@pytest.mark.parametrize(
    ("kind", "least", "most"), [("sine", 12.5, 14.5), ("repeat", 9.0, 13.5), ("profile", 15.0, 16.0)]
)
def test_the_supply_follows_a_waveform(page: Page, kind: str, least: float, most: float) -> None:
    page.locator("#wave-kind").select_option(kind)
    if kind == "repeat":
        page.get_by_label("points, seconds:volts").fill("0:13.5, 4.5:9")
    if kind == "profile":
        page.locator("#profile").select_option("lv124_e07_slow_fall_and_rise")
    page.locator("#wave-start").click()
    expect(owner(page, "supply_v")).to_have_text("hand")
    seen: set[float] = set()

    def varied() -> bool:
        seen.add(round(float(page.evaluate("hilplant.session.samples.value('in.supply_v')")), 3))
        return len(seen) > 5

    until(varied)
    assert least - 1e-9 <= min(seen) and max(seen) <= most + 1e-9
    page.locator("#wave-stop").click()
    expect(page.locator("#wave-state")).to_have_text("")
    control(page, "supply_v").locator(".release").click()
    expect(owner(page, "supply_v")).to_have_text("bus")


def test_a_fault_is_found_inserted_listed_and_removed(page: Page) -> None:
    page.locator("#tab-faults").click()
    page.locator("#fault-search").fill("current sensor gain")
    page.locator("#fault-search").fill("current_sensor_gain")
    page.get_by_label("factor").fill("0.5")
    page.locator("#stalk-slow").click()
    page.locator("#fault-insert").click()
    expect(page.locator("#faults-there [data-fault=current_sensor_gain]")).to_be_visible()
    until(lambda: output(page, "current_a") > 0.5)
    until(lambda: output(page, "measured_current_a") == pytest.approx(0.5 * output(page, "current_a"), rel=0.3))
    page.locator("#faults-there button").click()
    expect(page.locator("#faults-there")).to_have_text("none")
    page.get_by_label("for s").fill("2")
    page.locator("#fault-insert").click()
    expect(page.locator("#faults-there [data-fault=current_sensor_gain]")).to_be_visible()
    expect(page.locator("#faults-there")).to_have_text("none")
    page.locator("#stalk-off").click()


def test_frames_are_listed_with_period_values_and_bytes(page: Page) -> None:
    page.locator("#tab-frames").click()
    row = page.locator("#frames tr[data-message=MotorStatus]")
    expect(row).to_contain_text("MotorCurrent")
    period = row.locator("td").nth(3)
    until(lambda: 5.0 < float(period.inner_text()) < 200.0)
    counted = row.locator("td").nth(5)
    before = int(counted.inner_text())
    until(lambda: int(counted.inner_text()) > before)
    page.locator("#raw").check()
    expect(row.locator("td").nth(7)).to_have_text(re.compile(r"^([0-9a-f]{2} ?)+$"))
    expect(page.locator("#causes")).to_contain_text("unknown_frame 0")


def test_the_ecus_chart_and_the_park_circuit_show_what_is_now(page: Page) -> None:
    page.locator("#tab-ecu").click()
    page.locator("#stalk-slow").click()
    expect(page.locator("#ecu-live")).to_have_text("slow")
    assert "live" in str(page.locator("g[data-state=slow]").get_attribute("class"))
    page.locator("#tab-circuit").click()
    expect(page.locator("[data-contact='ON/OFF relay']")).to_have_attribute("data-at", "30 supply")
    expect(page.locator("[data-contact='FAST/SLOW relay']")).to_have_attribute("data-at", "53 slow brush")
    page.locator("#stalk-off").click()
    expect(page.locator("[data-contact='ON/OFF relay']")).to_have_attribute("data-at", "31 ground")


def test_events_tell_commands_and_marks(page: Page) -> None:
    page.locator("#tab-events").click()
    page.locator("#mark").fill("here it was")
    page.locator("#put-mark").click()
    expect(page.locator("#events")).to_contain_text("hand mark here it was")
