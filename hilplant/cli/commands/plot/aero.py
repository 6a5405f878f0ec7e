"""`hilplant plot aero`."""

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import BenchName, Picture, Table, write_drawn

app = command_app()


@app.command(epilog="Example: hilplant plot aero spoiler aero.png")
def aero(bench: BenchName, out: Picture, table: Table = None) -> None:
    """Draw drag and lift of the blades over the speed.

    The bench's beside those of section 4.5 with and without a spoiler, Figure 4-30.
    """
    import numpy as np

    from hilplant.bench import load_bench
    from hilplant.plots.environment import plot_aero
    from hilplant.simulation.air_forces import air_columns

    loaded = load_bench(bench)
    plot_aero(loaded, out)
    typer.echo(f"{out} written")
    write_drawn(table, air_columns(loaded, np.linspace(0.0, 40.0, 401)))
