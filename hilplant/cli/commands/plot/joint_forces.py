"""`hilplant plot joint-forces`."""

from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import BenchName, JsonFile, Picture, Table, TurnsAMinute, write_drawn, write_json
from hilplant.units import RAD_PER_S_PER_RPM

app = command_app()


@app.command("joint-forces", epilog="Example: hilplant plot joint-forces default joints.png --screen dry")
def joint_forces(  # noqa: PLR0913, PLR0917
    bench: BenchName,
    out: Picture,
    turns: TurnsAMinute = 60.0,
    screen: Annotated[str, typer.Option(help="dry, tacky or wet")] = "dry",
    vehicle_speed: Annotated[float, typer.Option(help="wind [m/s]", min=0.0, max=100.0)] = 0.0,
    table: Table = None,
    json_file: JsonFile = None,
) -> None:
    """Draw what every joint carries over a turn, section 4.3.

    Forces of all joints and moments where bodies are fixed to each other, by Lagrange multipliers.
    """
    from hilplant.bench import load_bench
    from hilplant.failure import Failure
    from hilplant.plots.motion import plot_joint_loads
    from hilplant.simulation.crank_torque import WETNESS, Conditions
    from hilplant.simulation.joint_loads import joint_loads

    if screen not in WETNESS:
        raise Failure(f"--screen: one of {', '.join(WETNESS)}, not '{screen}'")
    loaded = load_bench(bench)
    found = joint_loads(loaded, turns * RAD_PER_S_PER_RPM, Conditions(WETNESS[screen], vehicle_speed))
    plot_joint_loads(found, out, f"{loaded.name}: {turns:g} turns a minute, {screen}, {vehicle_speed:g} m/s of wind")
    largest = {name: float(size.max()) for name, size in zip(found.names(), found.sizes_n(), strict=True)}
    for name, size in largest.items():
        typer.echo(f"{name:34}{size:9.1f} N")
    typer.echo(f"{out} written")
    write_drawn(table, found.columns())
    write_json(json_file, {f"{name.replace(' - ', '_to_')}_n": size for name, size in largest.items()})
