"""`hilplant plot training`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import BenchName, Picture, Seed, Table, write_drawn
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant plot training motor default data.png --table data.csv")
def training(
    network: Annotated[str, typer.Argument(help="torque, motor or estimator")],
    bench: BenchName,
    out: Picture,
    seed: Seed = 1,
    table: Table = None,
) -> None:
    """Draw the data that a network is trained with.

    Figures F-1 to F-4 (torque), F-6 and F-7 (motor), F-8 and F-9 (estimator). --table writes a file for each set, which
    `train torque --data` and `train motor --data` take.
    """
    need("train")
    from hilplant.bench import load_bench
    from hilplant.plots.training_data import plot_training_data
    from hilplant.train.drawn_data import training_data

    loaded = load_bench(bench)
    sets = training_data(network, loaded, seed)
    plot_training_data(sets, out, f"{loaded.name}: data of the network `{network}`")
    typer.echo(f"{out} written")
    for each in sets if table is not None else ():
        assert table is not None
        word = each.name.split()[0]
        write_drawn(Path(table.with_name(f"{table.stem}_{word}{table.suffix}")), each.columns)
