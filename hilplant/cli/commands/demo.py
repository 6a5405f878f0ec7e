"""`hilplant demo`."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.page_option import LOGS, Browser, PageAddress, PageLogs, Stream, WithPage, page_options
from hilplant.extras import missing, need

app = command_app()


@app.command(cls=WithPage, epilog="Example: hilplant demo --seconds 12 --out demo")
def demo(  # noqa: PLR0913, PLR0917
    seconds: Annotated[float | None, typer.Option(help="length of the demonstration")] = None,
    out: Annotated[Path, typer.Option(help="folder for the recording and the plot")] = Path("hilplant-demo"),
    page: PageAddress = None,
    logs: PageLogs = LOGS,
    browser: Browser = False,
    stream: Stream = "",
) -> None:
    """Show plant and stand-in ECU at work on an in-memory bus.

    Needs no CAN in the kernel and no privileges; leaves a recording, and with matplotlib a plot. With --page it is
    driven by hand on the operator's page, without end unless --seconds is given, and records only what is logged
    there.
    """
    options = page_options(page, logs, browser, stream)
    if options is not None:
        need("web")
        from hilplant.cli.actions.demo import run_demo_page
        from hilplant.operator_page.beside_run import STALK_AS_LINES

        run_demo_page(seconds, replace(options, stalk=STALK_AS_LINES))
        return
    if missing("recording"):
        need("demo")
    from hilplant.cli.actions.demo import run_demo

    run_demo(seconds, out)
