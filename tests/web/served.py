"""A page's server in a thread of the test, on a free port of the loopback."""

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from hilplant.web.access import Access
from hilplant.web.application import Page, application
from hilplant.web.serving import Address, serve


@contextmanager
def served(page: Page, access: Access) -> Iterator[str]:
    """Serve a page; gives its address without the fragment."""
    urls: list[str] = []
    ready, ended = threading.Event(), asyncio.Event()
    loop = asyncio.new_event_loop()

    def say(url: str) -> None:
        urls.append(url)
        ready.set()

    def work() -> None:
        loop.run_until_complete(serve(application(page, access), access, Address(port=0, chosen=True), say, ended))

    thread = threading.Thread(target=work)
    thread.start()
    try:
        assert ready.wait(20)
        yield urls[0].partition("#")[0]
    finally:
        loop.call_soon_threadsafe(ended.set)
        thread.join(20)
        loop.close()
