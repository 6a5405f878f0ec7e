"""`hilplant plot positions`."""

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import BenchName, Picture

app = command_app()


@app.command(epilog="Example: hilplant plot positions default wiper.png")
def positions(bench: BenchName, out: Picture) -> None:
    """Draw linkage, arms and blades in four positions."""
    from hilplant.bench import load_bench
    from hilplant.plots.positions import plot_positions as draw

    loaded = load_bench(bench)
    draw(loaded.plant.mechanics.wiper, out, f"{loaded.name}: {loaded.plant.mechanics.written.name}")
    typer.echo(f"{out} written")
