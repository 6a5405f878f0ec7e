"""`hilplant plot measurement`."""

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import Columns, DataName, Frames, Picture

app = command_app()


@app.command(epilog="Example: hilplant plot measurement rig.csv@wet rig.png")
def measurement(data: DataName, out: Picture, columns: Columns = "", frames: Frames = None) -> None:
    """Draw a measurement: voltage, current, park steps.

    As identification takes it, Figure 5-5.
    """
    from hilplant.measurements.named_data import read_named
    from hilplant.plots.measured import plot_measurement

    (named,) = read_named([data], columns, frames)
    plot_measurement(named.data, out)
    typer.echo(f"{out} written")
