"""`hilplant plot simulation`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import Picture

app = command_app()


@app.command(epilog="Example: hilplant plot simulation run.csv run.png --signal current_a --signal crank_angle_rad")
def simulation(
    result: Annotated[Path, typer.Argument(help="what simulate or export has written: .csv, .parquet, .mf4, .hilrec")],
    out: Picture,
    signal: Annotated[list[str] | None, typer.Option(help="a panel for this signal; repeatable")] = None,
) -> None:
    """Draw what `simulate` has written, over time."""
    from hilplant.plots.simulated import plot_simulated

    plot_simulated(result, out, signal or ())
    typer.echo(f"{out} written")
