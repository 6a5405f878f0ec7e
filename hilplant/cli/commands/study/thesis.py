"""`hilplant study thesis`."""

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, JsonFile, write_json

app = command_app()


@app.command(
    epilog="Example: hilplant study thesis",
)
def thesis(bench: BenchName = DEFAULT, json_file: JsonFile = None) -> None:
    """Run the thesis' own checks again.

    Of motor, park circuits and mechanics. Exit code 1 when one does not hold.
    """
    from hilplant.cli.report import print_report
    from hilplant.thesis.mechanics_studies import thesis_study

    claim(json_file)
    study = thesis_study(bench)
    print_report(study.parts)
    write_json(json_file, study.figures)
    raise typer.Exit(0 if study.holds else 1)
