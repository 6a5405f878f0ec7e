"""`hilplant study solver`."""

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, JsonFile, claim, write_json

app = command_app()


@app.command(
    short_help="Hold the step against an adaptive solver.",
    epilog="Example: hilplant study solver default",
)
def solver(bench: BenchName = DEFAULT, json_file: JsonFile = None) -> None:
    """Hold the step against an adaptive solver of the same equations.

    Start, wet and dry, brown-out, stall, reverse, park, wind. Exit code 1 when an error is above 0.5 % of range.
    """
    from hilplant.thesis.mechanics_command import solver_study

    claim(json_file)
    figures, within = solver_study(bench)
    write_json(json_file, figures)
    raise typer.Exit(0 if within else 1)
