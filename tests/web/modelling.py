"""The modelling page opened in a browser for a test, and what a user does there."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Page
from web.served import served

from hilplant.modelling.opening import DEFAULTS, open_model
from hilplant.modelling.page import LIMITS, modelling_page
from hilplant.modelling.session import ModellingSession
from hilplant.web.access import Access


@contextmanager
def modelling(page: Page, work: Path, bench: str | Path = DEFAULTS) -> Iterator[ModellingSession]:
    """Open the page of a bench, ready to be used."""
    session, access = ModellingSession(open_model(bench), work), Access(LIMITS)
    with served(modelling_page(session), access) as url:
        page.goto(f"{url}#token={access.token}")
        page.wait_for_selector("body[data-ready]")
        yield session
        session.jobs.stop()


def show(page: Page, panel: str) -> None:
    """Go to a panel."""
    page.click(f"nav button[data-panel={panel}]")


def enter(page: Page, name: str, value: str) -> None:
    """Type a value into the field of these keys, and wait until the server has taken it."""
    with page.expect_response(lambda answer: answer.url.endswith("/api/edit")) as answer:
        page.fill(f'[aria-label="{name}"]:visible', value)
        page.press(f'[aria-label="{name}"]:visible', "Tab")
    assert answer.value.ok, answer.value.text()


def put_point(page: Page, table: str, letter: str, point: tuple[float, float]) -> None:
    """Type a point into a table."""
    for axis, value in enumerate(point):
        cell = f'table[data-at="{table}"] tr[data-point="{letter}"] input[data-axis="{axis}"]'
        if float(page.input_value(cell)) == value:
            continue
        with page.expect_response(lambda answer: answer.url.endswith("/api/edit")):
            page.fill(cell, repr(value))
            page.press(cell, "Tab")
        page.wait_for_timeout(50)
