"""`hilplant check`."""

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, JsonFile, write_json

app = command_app()


@app.command(epilog="Example: hilplant check my_bench.yaml")
def check(bench: BenchName = DEFAULT, json_file: JsonFile = None) -> None:
    """Say all that is wrong with a bench, with file and line.

    When nothing is, say what the bench amounts to, and warn of what is doubtful.
    Exit code 0 when nothing is wrong, warnings or not, else 1.
    """
    from hilplant.bench.verdict import verdict_on

    found = verdict_on(bench)
    for problem in (*found.problems, *found.warnings):
        typer.echo(problem, err=True)
    typer.echo("\n".join(found.lines))
    write_json(json_file, found.figures)
    raise typer.Exit(1 if found.problems else 0)
