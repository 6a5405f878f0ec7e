"""The modelling page opened in a browser for a test, and what a user does there."""

import itertools
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
    """Type a point into a table, one cell right after the other, and wait until the server has taken all."""
    cells = [f'table[data-at="{table}"] tr[data-point="{letter}"] input[data-axis="{axis}"]' for axis in range(2)]
    new = [(cell, value) for cell, value in zip(cells, point, strict=True) if float(page.input_value(cell)) != value]
    answers = itertools.count(1)
    with page.expect_response(lambda answer: answer.url.endswith("/api/edit") and next(answers) == len(new)):
        for cell, value in new:
            page.fill(cell, repr(value))
            page.press(cell, "Tab")
