"""`hilplant validate`."""

from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import (
    DEFAULT,
    BenchOption,
    Columns,
    DataNames,
    Frames,
    JsonFile,
    write_json,
)
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant validate check.csv@dry --bench car.yaml --rms-current-a 0.2")
def validate(  # noqa: PLR0913, PLR0917
    data: DataNames,
    bench: BenchOption = DEFAULT,
    rms_current_a: Annotated[float | None, typer.Option(min=0.0, help="bound on the current's error, rms [A]")] = None,
    rms_edge_ms: Annotated[float | None, typer.Option(min=0.0, help="bound on the park edges' error, rms [ms]")] = None,
    columns: Columns = "",
    frames: Frames = None,
    json_file: JsonFile = None,
) -> None:
    """Validate a bench against recordings.

    Errors of current and park edges. Exit code 1 when one is above a bound that was given.
    """
    need("identify")
    from hilplant.cli.actions.validate import validate_files

    claim(json_file)
    good, figures = validate_files(data, bench, (columns, frames), (rms_current_a, rms_edge_ms))
    write_json(json_file, figures)
    raise typer.Exit(0 if good else 1)
