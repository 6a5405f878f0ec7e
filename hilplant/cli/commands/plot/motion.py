"""`hilplant plot motion`."""

from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import BenchName, Picture, Table, TurnsAMinute, write_drawn
from hilplant.units import RAD_PER_S_PER_RPM

app = command_app()


@app.command(epilog="Example: hilplant plot motion default motion.png --body left_rocker --table motion.csv")
def motion(  # noqa: PLR0913, PLR0917
    bench: BenchName,
    out: Picture,
    turns: TurnsAMinute = 60.0,
    seconds: Annotated[float, typer.Option(help="duration")] = 1.0,
    step: Annotated[float, typer.Option(help="step [s]")] = 0.002,
    body: Annotated[
        list[str] | None, typer.Option(help="a body, or left_blade_joint, left_tip_a, ...; repeatable")
    ] = None,
    table: Table = None,
) -> None:
    """Draw how bodies move over time.

    The planar kinematics of 4.2.4 at an even speed of the crank; --table has every body.
    """
    from hilplant.bench import load_bench
    from hilplant.mechanics.solved_motion import solve_motion
    from hilplant.plots.motion import plot_motion

    loaded = load_bench(bench)
    wiper = loaded.plant.mechanics.wiper
    solved = solve_motion(wiper, turns * RAD_PER_S_PER_RPM, seconds, step)
    shown = tuple(body or (wiper.left.rocker, wiper.right.rocker, "left_blade_joint", "right_blade_joint"))
    plot_motion(solved, shown, out, f"{loaded.name}: the crank turns {turns:g} times a minute")
    typer.echo(f"{out} written")
    write_drawn(table, solved.columns())
