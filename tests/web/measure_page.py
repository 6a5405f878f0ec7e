"""What a page costs and how quick it is: draws a second, sample to chart, heap, the loop's wake-up with and without.

::

    PYTHONPATH=tests:. python -m web.measure_page [SECONDS]

The lateness of the loop is read in its ring, without a page and with three, in turn. Then the same of a loop with a CPU
of its own, which the browser does not share either, as that of an operator at another machine does not.
"""

import contextlib
import os
import sys
import tempfile
import threading
from pathlib import Path

import numpy as np
from playwright.sync_api import Browser, Page, expect
from web.chromium import chromium, page_of
from web.plant_with_page import plant_with_page, shown

from hilplant.channel.run_files import run_named
from hilplant.runtime.follower import Follower

TURNS, TURN_S = 3, 15.0
_HEAP = "performance.memory.usedJSHeapSize"


def p99_us(ring: str, seconds: float) -> float:
    """Return how late 99 of 100 ticks began over the next seconds [us]."""
    threading.Event().wait(seconds)
    follower = Follower(ring)
    late = follower.late_us(round(seconds * 1000))
    follower.close()
    return float(np.percentile(late, 99))


def drawn(page: Page, seconds: float, rate_hz: int) -> str:
    """Return draws a second, latency and heap of one page."""
    page.locator("#rate").select_option(str(rate_hz))
    page.wait_for_timeout(3000)
    page.evaluate("() => { const s = hilplant.plots.stats; s.draws = 0; s.latencyMs.length = 0; }")
    heaps = []
    for _ in range(6):
        page.wait_for_timeout(seconds * 1000 / 6)
        heaps.append(page.evaluate(_HEAP) / 1e6)
    draws, latency = page.evaluate("[hilplant.plots.stats.draws, hilplant.plots.stats.latencyMs]")
    low, middle, high = (np.percentile(latency, share) for share in (50, 95, 99))
    heap = " ".join(f"{each:.1f}" for each in heaps)
    figures = f"sample to chart p50 {low:.1f} p95 {middle:.1f} p99 {high:.1f} ms, heap {heap} MB"
    return f"{rate_hz} Hz: {draws / seconds:.1f} draws/s, {figures}"


def in_turn(ring: str, browser: Browser, url: str) -> str:
    """Return how late the loop was without a page and with three, in turn, and the quotient of the medians."""
    without, three = [p99_us(ring, TURN_S)], []
    for _ in range(TURNS):
        with contextlib.ExitStack() as pages:
            for _ in range(3):
                page = pages.enter_context(page_of(browser))
                page.goto(url)
                expect(page.locator("#mode")).not_to_be_empty()
            page.wait_for_timeout(2000)
            three.append(p99_us(ring, TURN_S))
        without.append(p99_us(ring, TURN_S))
    told = [" ".join(f"{each:.0f}" for each in measured) for measured in (three, without)]
    ratio = np.median(three) / np.median(without)
    return f"wake-up p99: three pages {told[0]} us, none {told[1]} us: {ratio:.2f}"


def main() -> None:
    """Measure, and print."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    with (
        tempfile.TemporaryDirectory() as folder,
        plant_with_page(Path(folder) / "logs") as plant,
        chromium() as browser,
    ):
        with shown(browser, plant) as page:
            page.locator("#stalk-slow").click()
            for rate_hz in (32, 60):
                print(drawn(page, seconds, rate_hz), flush=True)
        ring = run_named(str(plant.loop_pid())).ring
        print(in_turn(ring, browser, plant.url), flush=True)
    cpus = os.sched_getaffinity(0)
    own = max(cpus)
    os.sched_setaffinity(0, cpus - {own} or cpus)
    with tempfile.TemporaryDirectory() as folder:
        bench = Path(folder) / "own_cpu.yaml"
        bench.write_text(f"extends: virtual.yaml\nname: own cpu\nloop: {{cpu: {own}}}\n")
        with plant_with_page(Path(folder) / "logs", ["run", str(bench)]) as plant, chromium() as browser:
            ring = run_named(str(plant.process.pid)).ring
            print(f"a CPU of its own: {in_turn(ring, browser, plant.url)}")


if __name__ == "__main__":
    main()
