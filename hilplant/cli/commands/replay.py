"""`hilplant replay`."""

from dataclasses import asdict
from pathlib import Path

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import JsonFile, flat, write_json
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant replay run.hilrec")
def replay(recording: Path, json_file: JsonFile = None) -> None:
    """Run a recording's inputs again; compare every output bit.

    Exit code 0 when all are equal, else 1 with the first tick and signal that differ.
    """
    need("recording")
    from hilplant.recording.replay import replay as replay_recording

    result = replay_recording(recording)
    typer.echo(str(result))
    write_json(json_file, flat(asdict(result)))
    raise typer.Exit(0 if result.equal else 1)
