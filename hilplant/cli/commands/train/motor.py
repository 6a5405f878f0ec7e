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
def motor(  # noqa: PLR0913, PLR0917
    bench: BenchName = DEFAULT,
    scenarios: Annotated[int, typer.Option(min=1, help="wild scenarios that check the stated bounds")] = 2000,
    seed: Seed = 1,
    data: Annotated[
        list[str] | None,
        typer.Option(help="own data, FILE@slow or FILE@fast: time_s, terminal_v, current_a, crank_speed_rad_s"),
    ] = None,
    out: Out = Path("trained-motor"),
    json_file: JsonFile = None,
) -> None:
    """Train the motor network (NARX), section 6.4.3.

    Open loop first, then closed loop, a path for each brush. With --data from tables or recordings of your own. Ctrl-C
    keeps the best so far. Exit code 1 when a scenario finds it beyond the bounds that its file states.
    """
    need("train")
    from hilplant.cli.actions.train import run_training
    from hilplant.reports.motor import MotorOptions, report_motor

    claim(json_file)
    options = MotorOptions(seed, scenarios, out, tuple(data or ()))
    run_training(lambda on_progress: report_motor(bench, options, on_progress), json_file)
