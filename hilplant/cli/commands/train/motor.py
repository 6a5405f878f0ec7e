"""`hilplant train motor`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, JsonFile, Out, Seed
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant train motor default --out trained --seed 1")
def motor(
    bench: BenchName = DEFAULT,
    scenarios: Annotated[int, typer.Option(min=1, help="wild scenarios that check the stated bounds")] = 2000,
    seed: Seed = 1,
    out: Out = Path("trained-motor"),
    json_file: JsonFile = None,
) -> None:
    """Train the motor network (NARX), section 6.4.3.

    Open loop first, then closed loop, a path for each brush. Ctrl-C keeps the best so far. Exit code 1 when a scenario
    finds it beyond the bounds that its file states.
    """
    need("train")
    from hilplant.cli.actions.train import run_training
    from hilplant.reports.motor import report_motor

    claim(json_file)
    run_training(lambda on_progress: report_motor(bench, seed, scenarios, out, on_progress), json_file)
