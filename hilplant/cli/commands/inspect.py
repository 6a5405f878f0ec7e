"""`hilplant inspect`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import (
    JsonFile,
    write_json,
)
from hilplant.extras import need

app = command_app()


@app.command(
    epilog='Example: hilplant inspect rig.csv --columns "voltage=U1,current=I1[mA],park=PS"',
)
def inspect(  # noqa: PLR0913, PLR0917
    data: Path,
    columns: Annotated[str, typer.Option(help="role=NAME[unit],...: time, voltage, current, park, fast, on")] = "",
    frames: Annotated[str | None, typer.Option(help="bus database, or bench, that reads a log of CAN frames")] = None,
    mode: Annotated[str | None, typer.Option(help="slow or fast, where no column says it")] = None,
    gear_ratio: Annotated[float, typer.Option(min=1.0, help="turns of the motor in one turn of the crank")] = 63.0,
    json_file: JsonFile = None,
) -> None:
    """Say what is wrong with a measurement, and what it shows.

    What was done to it is told, and the motor that it shows. Exit code 0 when it will do for identification, else 1.
    """
    need("identify")
    from hilplant.cli.actions.inspect import Inspection, inspect_data

    claim(json_file)
    good, figures = inspect_data(Inspection(data, columns, frames, mode, gear_ratio))
    write_json(json_file, figures)
    raise typer.Exit(0 if good else 1)
