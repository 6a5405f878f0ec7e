"""`hilplant plot transfer-function`."""

from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import BenchName, Picture
from hilplant.extras import need

app = command_app()


@app.command("transfer-function", epilog="Example: hilplant plot transfer-function appendix_a answer.png")
def transfer_function(
    bench: BenchName,
    out: Picture,
    supply_v: Annotated[float, typer.Option("--supply", min=0.1, max=100.0, help="voltage [V]")] = 12.0,
) -> None:
    """Draw a motor's current by its equations and by (5.7).

    For a motor without load, Figure 5-7 beside Figure 3-10.
    """
    need("identify")
    from hilplant.bench import load_bench
    from hilplant.identify.transfer_answers import transfer_answers
    from hilplant.plots.measured import plot_transfer_answers

    loaded = load_bench(bench)
    found = transfer_answers(loaded, supply_v)
    plot_transfer_answers(found, out, f"{loaded.name}: {supply_v:g} V on and off")
    for each in found:
        typer.echo(f"{each.brush}: (5.7) is at most {each.worst_a:.2g} A from the plant's current")
    typer.echo(f"{out} written")
