"""What `hilplant page` does: a recording served to browsers on this machine until Ctrl-C."""

import asyncio
from pathlib import Path

import typer

from hilplant.bench import load_bench
from hilplant.operator_page.description import describe
from hilplant.operator_page.recorded import RecordedRows, RecordedScreen, differs
from hilplant.operator_page.server import operator_page
from hilplant.recording.span import Span
from hilplant.web.access import Access
from hilplant.web.application import application
from hilplant.web.serving import Address, open_browser, serve


def show_recording(path: Path, bench_name: str | None, span: Span, where: tuple[str, bool]) -> None:
    """Serve a recording; `where` is the address as written, and whether a browser is opened.

    Raises
    ------
    Failure
        When the recording, the bench or the address will not do.
    """
    address, browser = Address.parse(where[0]), where[1]
    rows = RecordedRows(path, span)
    bench = load_bench(bench_name or rows.run.name)
    for note in [*rows.notes, differs(rows, bench)]:
        if note:
            typer.echo(note, err=True)
    access = Access()

    def ready(url: str) -> None:
        typer.echo(f"page: {url}\nCtrl-C ends it")
        if browser:
            open_browser(url)

    page = operator_page(describe(bench), RecordedScreen(path, rows, bench, access).serve)
    asyncio.run(serve(application(page, access), access, address, ready))
