"""`hilplant simulate`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName

app = command_app()


@app.command(epilog="Example: hilplant simulate default slow_fast_park --out wipe.csv")
def simulate(
    bench: BenchName,
    out: Annotated[Path, typer.Option(help="file for one row a tick: .csv, .mf4 or .parquet")],
    scenario: Annotated[
        str | None, typer.Argument(help="a scenario file, or the name of a shipped scenario", metavar="SCENARIO")
    ] = None,
) -> None:
    """Run a scenario through the daemon's step, as fast as possible.

    With one name alone, it is the scenario's, and the bench is the default one.
    """
    from hilplant.simulation.run import simulate_to_file

    if scenario is None:
        bench, scenario = DEFAULT, bench
    typer.echo(simulate_to_file(bench, scenario, out))
