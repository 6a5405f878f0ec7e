"""The page's own process beside a run; started by :mod:`hilplant.operator_page.beside_run`.

Says ``ready ADDRESS`` or one line of error on standard output; the end of its standard input ends it.
"""

import asyncio
import contextlib
import json
import os
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse
from starlette.routing import Route

from hilplant.bench import Bench, load_bench
from hilplant.channel.run_files import RunFile
from hilplant.companion import READY
from hilplant.failure import Failure
from hilplant.operator_page.beside_run import STALK_AS_LINES, STALK_ON_BUS
from hilplant.operator_page.datagrams import Datagrams
from hilplant.operator_page.frames import LiveFrames
from hilplant.operator_page.metrics import CONTENT_TYPE, metrics
from hilplant.operator_page.screen import RunParts, Screen
from hilplant.operator_page.stalk import StalkOfLines, StalkOnBus
from hilplant.runtime.scheduling import stand_back
from hilplant.web.access import Access
from hilplant.web.application import Page, application
from hilplant.web.serving import Address, open_browser, serve
from hilplant.web.visitor import Visitor

STATIC = Path(__file__).parent / "static"


def operator_page(description: dict[str, Any], serve_one: Callable[[Visitor], Awaitable[None]]) -> Page:
    """Return the operator's page over what `serve_one` shows to each browser."""

    async def described(_: Request) -> JSONResponse:
        return JSONResponse(description)

    return Page(STATIC, [Route("/description", described)], serve=serve_one)


async def keep(order: dict[str, Any]) -> None:
    """Serve the page until the run has ended."""
    access, ended = Access(), asyncio.Event()
    failed: list[BaseException] = []
    run, bench = RunFile(**order["run"]), load_bench(order["bench_path"])
    bench = replace(bench, interface=order["interface"])
    stalk = _stalk(order["stalk"], bench)
    datagrams = Datagrams(run.ring, order["stream"]) if order["stream"] else None
    screen = Screen(run, access, RunParts(bench, stalk, LiveFrames(run.ring, bench), Path(order["logs"])))

    @contextlib.asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        works = [asyncio.create_task(each.work()) for each in (screen, stalk, datagrams) if each is not None]
        for work in works:
            work.add_done_callback(over)
        yield
        for work in works:
            work.cancel()

    def over(work: asyncio.Task[None]) -> None:
        """End the page with a work that fails: one that shows no more than half must not look as if it were alive."""
        if not work.cancelled() and (error := work.exception()) is not None:
            failed.append(error)
            ended.set()

    def ready(url: str) -> None:
        os.write(sys.stdout.fileno(), f"{READY} {url}\n".encode())
        if order["browser"]:
            open_browser(url)

    async def shown_metrics(_: Request) -> PlainTextResponse:
        text = metrics(screen.happenings.row, access.refused, access.sockets)
        return PlainTextResponse(text, media_type=CONTENT_TYPE)

    page = operator_page(order["description"], screen.serve)
    page = replace(page, public=[Route("/metrics", shown_metrics)], lifespan=lifespan)
    asyncio.get_running_loop().add_reader(sys.stdin.fileno(), ended.set)
    await serve(application(page, access), access, Address.parse(order["address"]), ready, ended)
    if failed:
        raise failed[0]


def _stalk(where: str, bench: Bench) -> StalkOfLines | StalkOnBus | None:
    if where == STALK_AS_LINES:
        return StalkOfLines(sys.stdout.fileno())
    try:
        return StalkOnBus(bench) if where == STALK_ON_BUS else None
    except Failure:
        return None  # the page says that there is none


def main() -> int:
    """Keep the page of the run that standard input describes."""
    order = json.loads(sys.stdin.readline())
    stand_back(order["loop_cpu"])
    try:
        asyncio.run(keep(order))
    except Failure as failure:
        sys.stdout.write(f"{failure}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
