"""`hilplant study thesis`."""

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, JsonFile, claim, write_json

app = command_app()


@app.command(
    short_help="Run the source's own checks again.",
    epilog="Example: hilplant study thesis",
)
def thesis(bench: BenchName = DEFAULT, json_file: JsonFile = None) -> None:
    """Run the source's own checks of motor, park circuits and mechanics.

    Exit code 1 when one does not hold.
    """
    from hilplant.thesis.mechanics_command import thesis_study

    claim(json_file)
    figures, holds = thesis_study(bench)
    write_json(json_file, figures)
    raise typer.Exit(0 if holds else 1)
