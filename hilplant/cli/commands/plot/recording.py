"""`hilplant plot recording`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import Picture
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant plot recording run.hilrec run.png")
def recording(recording: Annotated[Path, typer.Argument(help="what run --record has written")], out: Picture) -> None:
    """Draw a recording: voltage, current, arms, switches."""
    need("recording")
    from hilplant.plots.recording import plot_recording as draw

    draw(recording, out)
    typer.echo(f"{out} written")
