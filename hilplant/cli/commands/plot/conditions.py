"""`hilplant plot conditions`."""

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import BenchName, Picture

app = command_app()


@app.command(epilog="Example: hilplant plot conditions default conditions.png")
def conditions(bench: BenchName, out: Picture) -> None:
    """Draw the torque of five wipes, wet, in wind, and dry.

    That is the test of section 4.6.
    """
    from hilplant.bench import load_bench
    from hilplant.plots.mechanics import plot_conditions as draw

    draw(load_bench(bench), out)
    typer.echo(f"{out} written")
