from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page
from web.chromium import chromium, page_of


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """One headless Chromium for all tests of a session."""
    with chromium() as started:
        yield started


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """An empty page of 1280 x 800 in a session of its own."""
    with page_of(browser) as opened:
        yield opened
