"""`hilplant page`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.page_option import PageServedAt
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant page run.hilrec --browser")
def page(  # noqa: PLR0913, PLR0917
    recording: Annotated[Path, typer.Argument(help="the recording to look at")],
    address: PageServedAt = "",
    bench: Annotated[str | None, typer.Option(help="its bench; the one of its name if left out")] = None,
    from_s: Annotated[float, typer.Option("--from", min=0.0, help="from this time on [s]")] = 0.0,
    to_s: Annotated[float, typer.Option("--to", help="up to this time [s]")] = float("inf"),
    browser: Annotated[bool, typer.Option("--browser", help="open it in your browser")] = False,
) -> None:
    """Show a recording on the operator's page, with a cursor in time.

    Ends on Ctrl-C. Up to half an hour is shown at once; --from and --to choose it.
    """
    need("web")
    need("recording")
    from hilplant.cli.actions.page import show_recording
    from hilplant.recording.span import Span

    show_recording(recording, bench, Span(from_s, to_s), (address, browser))
