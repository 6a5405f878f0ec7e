"""What a page costs and how quick it is: draws a second, sample to chart, heap, the loop's wake-up with and without.

::

    PYTHONPATH=tests:. python -m web.measure_page [SECONDS]

One plant runs throughout; its loop's lateness is read in the ring, first without a page, then with three.
"""

import contextlib
import sys
import tempfile
import threading
from pathlib import Path

import numpy as np
from playwright.sync_api import Page
from web.chromium import chromium
from web.plant_with_page import plant_with_page, shown

from hilplant.channel.run_files import run_named
from hilplant.runtime.follower import Follower

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


def main() -> None:
    """Measure, and print."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    with (
        tempfile.TemporaryDirectory() as folder,
        plant_with_page(Path(folder) / "logs") as plant,
        chromium() as browser,
    ):
        ring = run_named(str(plant.loop_pid())).ring
        without = [p99_us(ring, 10.0)]
        with shown(browser, plant) as page:
            page.locator("#stalk-slow").click()
            for rate_hz in (32, 60):
                print(drawn(page, seconds, rate_hz), flush=True)
        without.append(p99_us(ring, 10.0))
        with contextlib.ExitStack() as pages:
            for index in range(3):
                pages.enter_context(shown(browser, plant, lead=index == 0))
            three = p99_us(ring, 20.0)
        without.append(p99_us(ring, 10.0))
    print(f"wake-up p99: three pages {three:.0f} us; none {', '.join(f'{each:.0f}' for each in without)} us")


if __name__ == "__main__":
    main()
