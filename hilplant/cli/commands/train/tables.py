"""`hilplant train tables`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, JsonFile, Out
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant train tables default --bound 1e-8 --out tables")
def tables(
    bench: BenchName = DEFAULT,
    bound: Annotated[float, typer.Option(min=1e-10, max=1.0, help="largest error, by the largest value")] = 1e-8,
    out: Out = Path("trained-tables"),
    json_file: JsonFile = None,
) -> None:
    """Tabulate positions, velocities and accelerations, section 6.2.

    With as few knots as keep all of them within a bound.
    """
    need("train")
    from hilplant.cli.actions.train import run_training
    from hilplant.reports.kinematic_tables import train_tables

    claim(json_file)
    run_training(lambda _: train_tables(bench, bound, out), json_file)
