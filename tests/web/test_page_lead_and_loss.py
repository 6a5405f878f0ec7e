"""Who leads, and what becomes of what is held when a page, the loop or the whole run goes."""

import time
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, expect
from web.plant_with_page import PlantWithPage, confirmed, control, kill, owner, plant_with_page, shown, until

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]


@pytest.fixture(scope="module")
def plant(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PlantWithPage]:
    with plant_with_page(tmp_path_factory.mktemp("page") / "logs") as running:
        yield running


def test_one_page_leads_the_other_watches_asks_and_is_given_the_lead(browser: Browser, plant: PlantWithPage) -> None:
    with shown(browser, plant) as first, shown(browser, plant, lead=False) as second:
        expect(second.locator("#lead")).to_have_text("Watching: ask for the lead")
        expect(second.locator("#stalk-slow")).to_be_disabled()
        refused = second.evaluate("hilplant.session.command('override', {values: {supply_v: 9}}, 'x')")
        assert refused is False
        expect(second.locator("#note")).to_contain_text("another page has the lead")
        control(first, "supply_v").locator("input").fill("11")
        control(first, "supply_v").locator("input").press("Enter")
        expect(confirmed(second, "supply_v")).to_have_text("11.00 V")
        second.locator("#lead").click()
        expect(first.locator("#asking")).to_contain_text("1 page asking")
        first.locator("#lead").click()
        expect(second.locator("#lead")).to_contain_text("You have the lead")
        expect(first.locator("#lead")).to_contain_text("Watching")
        expect(confirmed(second, "supply_v")).to_have_text("13.50 V")  # what the first held is released with its lead


def test_a_page_that_goes_or_hangs_lets_go_of_what_it_held(browser: Browser, plant: PlantWithPage) -> None:
    with shown(browser, plant, lead=False) as watcher:
        watcher.locator("#lead").click()  # gives it up: whoever comes next has it
        for end in ("goes", "hangs"):
            with shown(browser, plant) as page:
                control(page, "supply_v").locator("input").fill("9")
                control(page, "supply_v").locator("input").press("Enter")
                expect(confirmed(watcher, "supply_v")).to_have_text("9.000 V")
                if end == "hangs":
                    page.evaluate("() => { hilplant.session.link.say = () => {}; }")  # no sign of life any more
                    expect(confirmed(watcher, "supply_v")).to_have_text("13.50 V", timeout=6000)
            expect(confirmed(watcher, "supply_v")).to_have_text("13.50 V")
            expect(owner(watcher, "supply_v")).to_have_text("bus")


def test_nothing_comes_from_anywhere_but_the_loopback(browser: Browser, plant: PlantWithPage) -> None:
    with shown(browser, plant, lead=False) as page:
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.reload()
        expect(page.locator("#mode")).to_have_text("running")
        assert len(asked) > 10
        assert all(url.startswith("http://127.0.0.1:") for url in asked), asked


def test_the_banner_is_there_within_a_second_of_the_loops_death(browser: Browser, plant: PlantWithPage) -> None:
    """The last test: it ends the plant of this file."""
    with shown(browser, plant) as page:
        page.evaluate("""() => { new MutationObserver(() => { window.seen = Date.now(); })
            .observe(document.getElementById("banner"), { attributes: true }); }""")
        loop = plant.loop_pid()
        killed_ms = 1e3 * time.time()
        kill(loop)
        expect(page.locator("#banner")).to_be_visible()
        until(lambda: page.evaluate("window.seen ?? 0") > 0)
        assert page.evaluate("window.seen") - killed_ms < 1000
        expect(page.locator("#stalk-slow")).to_be_disabled()
