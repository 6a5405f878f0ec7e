"""`hilplant study solver`."""

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, JsonFile, write_json

app = command_app()


@app.command(
    epilog="Example: hilplant study solver default",
)
def solver(bench: BenchName = DEFAULT, json_file: JsonFile = None) -> None:
    """Hold the step against an adaptive solver.

    It has the same equations. Start, wet and dry, brown-out, stall, reverse, park, wind. Exit code 1 when an error is
    above 0.5 % of range.
    """
    from hilplant.cli.report import print_report
    from hilplant.thesis.mechanics_studies import solver_study

    claim(json_file)
    study = solver_study(bench)
    print_report(study.parts)
    write_json(json_file, study.figures)
    raise typer.Exit(0 if study.holds else 1)
