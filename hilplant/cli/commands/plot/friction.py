"""`hilplant plot friction`."""

from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import BenchName, Picture, Table, write_drawn

app = command_app()


@app.command(epilog="Example: hilplant plot friction default friction.png")
def friction(
    bench: BenchName,
    out: Picture,
    published: Annotated[
        bool, typer.Option("--published", help="the sets of Tables 4-1 and 4-2 instead: Figures 4-22 and 4-26")
    ] = False,
    table: Table = None,
) -> None:
    """Draw the blades' friction over their speed.

    With the speeds that the blades have in a turn, and where the curves are held.
    """
    import numpy as np

    from hilplant.bench import load_bench
    from hilplant.plots.environment import plot_friction, plot_published_friction
    from hilplant.simulation.friction_curves import friction_columns

    loaded = load_bench(bench)
    if published:
        plot_published_friction(out)
    else:
        plot_friction(loaded, out)
    typer.echo(f"{out} written")
    write_drawn(table, friction_columns(loaded, np.linspace(0.0, 3000.0, 3001)))
