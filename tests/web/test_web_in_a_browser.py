"""What the pages share, in a real browser: token out of sight, theme, charts' library, answers on the socket."""

from pathlib import Path

import pytest
from playwright.sync_api import Page as BrowserPage
from playwright.sync_api import expect
from web.served import served

from hilplant.web.access import Access
from hilplant.web.application import Page
from hilplant.web.visitor import Visitor

pytestmark = pytest.mark.browser

INDEX = """<!doctype html><html lang="en"><head><meta charset="utf-8"><title>test</title>
<link rel="stylesheet" href="/shared/page.css"><script src="/vendor/uPlot.iife.min.js"></script>
<script type="module" src="page.js"></script></head><body><p id="said"></p></body></html>"""
SCRIPT = """import { Link } from "/shared/link.js";
import { toggleTheme } from "/shared/theme.js";
window.toggleTheme = toggleTheme;
const said = document.getElementById("said");
const link = new Link();
link.addEventListener("closed", (event) => { said.textContent = event.detail; });
link.addEventListener("open", () =>
  link.ask("double", { value: 21 }).then((answer) => { said.textContent = String(answer.value); }, () => {}));
"""


async def _serve(visitor: Visitor) -> None:
    async for message in visitor.messages():
        await visitor.tell({"id": message["id"], "value": 2 * message["value"]})


def test_the_token_leaves_the_address_and_a_reload_still_knows_it(page: BrowserPage, tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text(INDEX)
    (tmp_path / "page.js").write_text(SCRIPT)
    access = Access()
    with served(Page(tmp_path, serve=_serve), access) as url:
        page.goto(f"{url}#token={access.token}")
        expect(page.locator("#said")).to_have_text("42")
        assert page.url == url
        page.reload()
        expect(page.locator("#said")).to_have_text("42")
        assert page.evaluate("typeof uPlot") == "function"
        before = page.evaluate("document.documentElement.dataset.theme")
        page.evaluate("toggleTheme()")
        assert page.evaluate("document.documentElement.dataset.theme") != before
        page.evaluate("sessionStorage.clear()")
        page.reload()
        expect(page.locator("#said")).to_contain_text("the token is wrong")
