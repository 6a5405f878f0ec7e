"""`hilplant study control`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, JsonFile, write_json
from hilplant.extras import need

app = command_app()


@app.command(
    epilog="Example: hilplant study control --out study --json study.json",
)
def control(
    bench: BenchName = DEFAULT,
    out: Annotated[Path | None, typer.Option(help="folder for the pictures")] = None,
    search: Annotated[bool, typer.Option("--search", help="search better gains instead; takes minutes")] = False,
    json_file: JsonFile = None,
) -> None:
    """Compare all velocity controllers, section 7.2.

    With the speed sensor and without it, and through an hour of rain.
    """
    if out is not None:
        need("plot")
    from hilplant.cli.actions.study_control import control_figures

    claim(json_file)
    write_json(json_file, control_figures(bench, out, search))
