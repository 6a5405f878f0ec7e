"""`hilplant plot stall`."""

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import Picture
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant plot stall stall.png")
def stall(out: Picture) -> None:
    """Draw a warm motor that stalls, trips and recovers.

    With the simulated ECU as shipped, and with one that knows only the stall of a cold motor. Takes a minute or two.
    """
    need("testing")
    from hilplant.plots.stall import draw_stalls
    from hilplant.testing.stalls import stalls

    draw_stalls(stalls(), out)
    typer.echo(f"{out} written")
