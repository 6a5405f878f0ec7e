"""`hilplant export`."""

from pathlib import Path

import typer

from hilplant.cli.groups import command_app
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant export run.hilrec run.mf4")
def export(recording: Path, out: Path) -> None:
    """Convert a recording to .mf4, .blf, .asc, .csv or .parquet."""
    need("recording")
    from hilplant.recording.export import export as export_recording

    typer.echo(export_recording(recording, out))
