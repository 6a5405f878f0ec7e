"""`hilplant plot park`."""

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import Picture

app = command_app()


@app.command(epilog="Example: hilplant plot park park.png")
def park(out: Picture) -> None:
    """Draw slow, fast, off with the three park circuits."""
    from hilplant.plots.park import plot_park_sequences

    plot_park_sequences(out)
    typer.echo(f"{out} written")
