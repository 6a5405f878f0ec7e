"""`hilplant study surrogates`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import JsonFile, write_json
from hilplant.extras import need

app = command_app()


@app.command(
    epilog="Example: hilplant study surrogates --seconds 600 --out study",
)
def surrogates(
    seconds: Annotated[float, typer.Option(min=40.0, help="how long each model drives the bus")] = 600.0,
    out: Annotated[Path | None, typer.Option(help="folder for the picture")] = None,
    json_file: JsonFile = None,
) -> None:
    """Compare cost and accuracy of all loads and motors.

    And what an ECU sees of them. Exit code 1 when to the ECU one is not as good as the physics that it stands for.
    """
    need("train")
    from hilplant.atomic_write import make_folder
    from hilplant.thesis.surrogate_study import all_kept, compare, figures, lines, plot

    claim(json_file)
    picture = None if out is None else make_folder(out) / "surrogates.png"
    compared = compare(seconds)
    typer.echo("\n".join(lines(compared, seconds)))
    if picture is not None:
        plot(compared, picture)
        typer.echo(f"{picture} written")
    write_json(json_file, figures(compared, seconds))
    raise typer.Exit(0 if all_kept(compared) else 1)
