"""`hilplant plot torque`."""

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import BenchName, Picture

app = command_app()


@app.command(epilog="Example: hilplant plot torque default torque.png")
def torque(bench: BenchName, out: Picture) -> None:
    """Draw the torque over the crank angle by screen."""
    from hilplant.bench import load_bench
    from hilplant.plots.mechanics import plot_torque as draw

    draw(load_bench(bench), out)
    typer.echo(f"{out} written")
