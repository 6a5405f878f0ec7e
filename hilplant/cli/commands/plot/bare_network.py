"""`hilplant plot bare-network`."""

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import BenchName, JsonFile, Picture, Table, write_drawn, write_json

app = command_app()


@app.command("bare-network", epilog="Example: hilplant plot bare-network networks bare.png")
def bare_network(bench: BenchName, out: Picture, table: Table = None, json_file: JsonFile = None) -> None:
    """Draw how a motor network fails alone, Figure 6-23.

    Beside it the guarded one, which hands over to the physical motor, and that motor itself.
    """
    from hilplant.bench import load_bench
    from hilplant.plots.motor_network import plot_bare_run
    from hilplant.train.bare_network import BEYOND, bare_run

    found = bare_run(load_bench(bench))
    plot_bare_run(found, out)
    figures: dict[str, float] = {}
    for name in ("bare", "guarded"):
        errors = found.errors(name)
        figures |= errors
        for part in (*BEYOND, "after"):
            current, speed = (errors[f"{name}_{part}_{unit}"] for unit in ("current_a", "crank_speed_rad_s"))
            typer.echo(f"{name:8} {part.replace('_', ' '):8} wrong by up to {current:.3g} A, {speed:.3g} rad/s")
    typer.echo(f"{out} written")
    write_drawn(table, found.columns())
    write_json(json_file, figures)
