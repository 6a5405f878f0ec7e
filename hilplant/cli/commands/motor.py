"""`hilplant motor`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import JsonFile, write_json
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant motor my_readings.yaml --out my_motor.yaml")
def motor(
    readings: Annotated[Path, typer.Argument(help="readings on a bench, or a data sheet, in YAML", metavar="READINGS")],
    out: Annotated[Path, typer.Option(help="motor file to write")],
    json_file: JsonFile = None,
) -> None:
    """Make a motor file from readings or a data sheet.

    With the standard error of each parameter; docs/identification.md says what the file of readings holds.
    """
    need("identify")
    from hilplant.motor_bench.motor_file import motor_from_readings

    claim(out)
    claim(json_file)
    found = motor_from_readings(readings, out)
    for name, value in found.values.items():
        error = ", given" if name in found.given else f" +- {value.s:.2g}" if value.s else ", without an error"
        typer.echo(f"  {name:22} {value.n:.6g}{error}")
    typer.echo(f"{out} written; put it under `motor` of a bench")
    write_json(json_file, found.figures)
