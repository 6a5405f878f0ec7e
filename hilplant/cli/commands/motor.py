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
    readings: Annotated[
        Path, typer.Argument(help="readings on a bench, a data sheet, or windings, in YAML", metavar="READINGS")
    ],
    out: Annotated[Path, typer.Option(help="motor file to write")],
    json_file: JsonFile = None,
) -> None:
    """Make a motor file from readings, a data sheet, or windings.

    Readings give each parameter its standard error; windings are magnets, coils and brushes.
    docs/identification.md says what the file of readings holds.
    """
    need("identify")
    from hilplant.motor_bench.motor_file import motor_from_readings

    claim(out)
    claim(json_file)
    found = motor_from_readings(readings, out)
    for name, value in found.values.items():
        error = ", given" if name in found.given else f" +- {value.s:.2g}" if value.s else ", without an error"
        typical = ", typical" if name in found.typical else ""
        typer.echo(f"  {name:22} {value.n:.6g}{error}{typical}")
    if found.windings is not None:
        counts = found.figures
        slow, fast = counts["slow_coils_counted"], counts["fast_coils_counted"]
        typer.echo(f"  both paths together: {slow:.4g} K_t slow, {fast:.4g} K_t fast; between the brushes half of it")
        typer.echo(f"  fast over slow {fast / slow:.3f}; measured motors have 0.66 to 0.75")
        slow, fast = counts["slow_path_resistance"], counts["fast_path_resistance"]
        typer.echo(
            f"  resistance by the paths of Figure 3-9: {slow:.4g} coils slow, {fast:.4g} coils fast, brushes apart"
        )
        typer.echo(
            f"  fast over slow {fast / slow:.3f}; measured motors have 0.60 to 0.89, with brushes and wear in them"
        )
        typer.echo(
            f"  inductance by the same paths, coils without mutual flux: fast over slow {fast / slow:.3f}; "
            "measured motors have 0.80 to 0.99, Table 5-6 2.1"
        )
    typer.echo(f"{out} written; put it under `motor` of a bench")
    write_json(json_file, found.figures)
