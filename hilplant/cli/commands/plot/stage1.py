"""`hilplant plot stage1`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import Columns, DataName, Frames, Picture, Table, write_drawn
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant plot stage1 rig.csv@wet stage1.png --held-out other.csv@wet")
def stage1(  # noqa: PLR0913, PLR0917
    data: DataName,
    out: Picture,
    held_out: Annotated[str | None, typer.Option(help="a recording to answer instead of the data's own")] = None,
    columns: Columns = "",
    frames: Frames = None,
    gear_ratio: Annotated[float, typer.Option(min=1.0, help="turns of the motor in one turn of the crank")] = 63.0,
    table: Table = None,
) -> None:
    """Draw stage 1: its data and the transfer function.

    For each mode, Figures 5-8 to 5-11.
    """
    need("identify")
    from hilplant.identify.first_stage import first_stage
    from hilplant.identify.stage_one_signals import stage_one_signals
    from hilplant.measurements.named_data import read_named
    from hilplant.plots.measured import plot_stage_one

    named = read_named([data, *([held_out] if held_out else [])], columns, frames)
    results = first_stage(named[0].data, gear_ratio)
    found = stage_one_signals(results, named[-1].data)
    plot_stage_one(found, out, named[-1].text)
    for each in found:
        typer.echo(f"{each.mode}: the transfer function's answer is {each.rms_a:.4g} A rms from the measured current")
    for mode, text in results.failures.items():
        typer.echo(f"{mode}: nothing settles: {text}")
    typer.echo(f"{out} written")
    for each in found if table is not None else ():
        assert table is not None
        write_drawn(Path(table.with_name(f"{table.stem}_{each.mode}{table.suffix}")), each.columns())
