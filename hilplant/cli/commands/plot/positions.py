"""`hilplant plot positions`."""

from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import BenchName, Picture, numbers_of

app = command_app()

#: The thesis' four of Figure 4-9, and the same in the way back [deg].
_FORTH, _BACK = "0,60,120,180", "180,240,300,360"


@app.command(epilog="Example: hilplant plot positions default wiper.png --at 200,250,300,340")
def positions(
    bench: BenchName,
    out: Picture,
    at: Annotated[str, typer.Option(help="crank angles from park [deg], with commas between")] = "",
    back: Annotated[bool, typer.Option("--back", help="four angles of the way back")] = False,
) -> None:
    """Draw linkage, arms and blades at some crank angles.

    Without --at the four of Figure 4-9.
    """
    from hilplant.bench import load_bench
    from hilplant.plots.positions import plot_positions as draw

    loaded = load_bench(bench)
    angles = numbers_of("--at", at or (_BACK if back else _FORTH))
    draw(loaded.plant.mechanics.wiper, out, f"{loaded.name}: {loaded.plant.mechanics.written.name}", angles)
    typer.echo(f"{out} written")
