"""`hilplant study surrogates`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import JsonFile, claim, write_json

app = command_app()


@app.command(
    short_help="Compare cost and accuracy of all loads and motors.",
    epilog="Example: hilplant study surrogates --seconds 600 --out study",
)
def surrogates(
    seconds: Annotated[float, typer.Option(min=40.0, help="how long each model drives the bus")] = 600.0,
    out: Annotated[Path | None, typer.Option(help="folder for the picture")] = None,
    json_file: JsonFile = None,
) -> None:
    """Compare cost and accuracy of all loads and motors, and what an ECU sees of them.

    Exit code 1 when to the ECU one is not as good as the physics that it stands for.
    """
    from hilplant.thesis.surrogate_study import surrogates_study

    claim(json_file)
    kept, figures = surrogates_study(seconds, out)
    write_json(json_file, figures)
    raise typer.Exit(0 if kept else 1)
