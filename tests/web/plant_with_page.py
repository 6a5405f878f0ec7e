"""A demonstration with its page as the processes that they are, and a browser's page on it."""

import os
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import Browser, Locator, Page, expect
from web.chromium import page_of

_START_S = 180.0


@dataclass
class PlantWithPage:
    """A plant that runs, the address of its page with the token, and the folder of its logs."""

    process: "subprocess.Popen[str]"
    url: str
    logs: Path

    def loop_pid(self) -> int:
        """Return the process of the loop, a child of the command."""
        children = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        loops = [each for each in children if b"spawn_main" in Path(f"/proc/{each}/cmdline").read_bytes()]
        return int(loops[0])


@contextmanager
def plant_with_page(logs: Path, what: Sequence[str] = ("demo",)) -> Iterator[PlantWithPage]:
    """Start a demonstration, or what else serves a page, and end it."""
    command = [sys.executable, "-m", "hilplant", *what, "--page", "0", "--logs", str(logs), "--seconds", "3600"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=logs.parent)
    watch = threading.Timer(_START_S, process.kill)
    watch.start()
    try:
        assert process.stdout is not None
        said = ""
        while (found := re.search(r"page: (\S+)", said)) is None:
            line = process.stdout.readline()
            assert line, said
            said += line
        watch.cancel()
        threading.Thread(target=process.stdout.read, daemon=True).start()
        yield PlantWithPage(process, found[1], logs)
    finally:
        watch.cancel()
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
        try:
            process.wait(30)
        except subprocess.TimeoutExpired:
            process.kill()


@contextmanager
def shown(browser: Browser, plant: PlantWithPage, width: int = 1280, lead: bool = True) -> Iterator[Page]:
    """Show the plant's page in a session of its own; with `lead`, once it has it."""
    with page_of(browser, width) as page:
        page.goto(plant.url)
        expect(page.locator("#mode")).to_have_text("running")
        if lead:
            expect(page.locator("#lead")).to_contain_text("You have the lead")
        yield page


def control(page: Page, name: str) -> Locator:
    """Return the control of an input."""
    return page.locator(f"[data-input={name}]")


def confirmed(page: Page, name: str) -> Locator:
    """Return what the plant has at an input, as the page shows it."""
    return control(page, name).locator(".confirmed")


def owner(page: Page, name: str) -> Locator:
    """Return who commands an input, as the page shows it."""
    return control(page, name).locator(".owner")


def until(what: Callable[[], object], seconds: float = 20.0) -> None:
    """Wait until something holds."""
    pause = threading.Event()
    for _ in range(int(seconds / 0.05)):
        if what():
            return
        pause.wait(0.05)
    raise AssertionError(f"not within {seconds:g} s")


def kill(pid: int) -> None:
    """Kill a process at once."""
    os.kill(pid, signal.SIGKILL)
