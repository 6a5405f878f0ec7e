"""`hilplant plot staircase`."""

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import Columns, DataName, Frames, Picture, Table, write_drawn

app = command_app()


@app.command(epilog="Example: hilplant plot staircase rig.csv@wet stairs.png --table stairs.csv")
def staircase(data: DataName, out: Picture, columns: Columns = "", frames: Frames = None, table: Table = None) -> None:
    """Draw the park contact as pulses and as stairs.

    Beside a model that is a little slow, slow, and at rest: the error of pulses is least where nothing moves, that of
    stairs is largest there. Figures 5-2 and 5-3.
    """
    from hilplant.measurements.named_data import read_named
    from hilplant.measurements.park_cases import park_cases
    from hilplant.plots.measured import plot_staircase

    (named,) = read_named([data], columns, frames)
    cases = park_cases(named.data)
    plot_staircase(named.data, cases, out)
    for case in cases:
        typer.echo(f"case {case.name}: mean error of pulses {case.pulse_error:.4f}, of stairs {case.stair_error:.4f}")
    typer.echo(f"{out} written")
    written = {"time_s": named.data.time_s, "park": named.data.park, "park_steps": named.data.park_steps}
    for case in cases:
        written |= {f"case_{case.name}_park": case.pulses, f"case_{case.name}_steps": case.stairs}
    write_drawn(table, written)
