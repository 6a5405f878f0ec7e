"""`hilplant study identification`."""

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import JsonFile, write_json
from hilplant.extras import need

app = command_app()


@app.command(
    epilog="Example: hilplant study identification --json study.json",
)
def identification(json_file: JsonFile = None) -> None:
    """Compute Tables 5-2 to 5-5 again.

    Each printed number stands beside ours. Exit code 1 when one is neither reached nor explained by rounding.
    """
    need("identify")
    from hilplant.thesis.published import as_table, figures, published_lines

    lines = published_lines()
    typer.echo(as_table(lines))
    write_json(json_file, figures(lines))
    raise typer.Exit(1 if any(line.agrees == "no" for line in lines) else 0)
