"""`hilplant export`."""

import math
from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant export run.hilrec run.mf4 --from 60 --to 90")
def export(
    recording: Path,
    out: Path,
    from_s: Annotated[
        float, typer.Option("--from", min=0.0, help="begin at this time [s] since the run's start")
    ] = 0.0,
    to_s: Annotated[float, typer.Option("--to", min=0.0, help="end before this time [s]")] = math.inf,
) -> None:
    """Convert a recording to .mf4, .blf, .asc, .csv or .parquet.

    The name of a recording in parts, as it was given to --record, stands for all of them; that of one part for itself.
    """
    need("recording")
    from hilplant.recording.export import export as export_recording
    from hilplant.recording.span import Span

    typer.echo(export_recording(recording, out, Span(from_s, to_s)))
