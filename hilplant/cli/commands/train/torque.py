"""`hilplant train torque`."""

from itertools import pairwise
from pathlib import Path
from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, JsonFile, Out, Seed
from hilplant.extras import need
from hilplant.failure import Failure

#: No wiper's crank turns faster: two hundred wipes a minute.
_FASTEST_RAD_S = 21.0

app = command_app()


@app.command(epilog="Example: hilplant train torque default --out trained --seed 1")
def torque(  # noqa: PLR0913, PLR0917
    bench: BenchName = DEFAULT,
    neurons: Annotated[int, typer.Option(min=1, max=64, help="tanh neurons in the one hidden layer")] = 10,
    harmonics: Annotated[
        int, typer.Option(min=0, max=2, help="0: the angle itself goes in; else sines and cosines up to this multiple")
    ] = 2,
    starts: Annotated[int, typer.Option(min=1, max=1000, help="trainings, of which the best is kept")] = 10,
    speeds: Annotated[str, typer.Option(help="crank speeds [rad/s] of the wipes, with commas between")] = "1,3,5,7",
    scenarios: Annotated[int, typer.Option(min=1, help="random runs against the physical plant, for the report")] = 200,
    seed: Seed = 1,
    study: Annotated[bool, typer.Option("--study", help="Table 6-1 instead: 1 to 20 neurons, thrice each")] = False,
    data: Annotated[
        Path | None, typer.Option(help="own data: crank_angle_rad, crank_speed_rad_s, dry_torque_n_m, wet_torque_n_m")
    ] = None,
    validation: Annotated[Path | None, typer.Option(help="own data to judge by; else a tenth of --data")] = None,
    out: Out = Path("trained-torque"),
    json_file: JsonFile = None,
) -> None:
    """Train the torque network of the whole wiper, section 6.4.2.

    From the bench's plant, or with --data from a table of your own. Ctrl-C keeps the best so far. Exit code 1 when a
    random run finds it beyond the bound that its file states.
    """
    need("train")
    from hilplant.cli.actions.train import run_training
    from hilplant.reports.torque import TorqueOptions, train_torque
    from hilplant.reports.torque_sizes import study_torque

    claim(json_file)
    if validation is not None and data is None:
        raise Failure("--validation: goes with --data")
    options = TorqueOptions(neurons, harmonics, starts, _speeds(speeds), seed, scenarios, out, data, validation)
    if study:
        run_training(lambda on_progress: study_torque(bench, options, 20, on_progress), json_file)
    else:
        run_training(lambda on_progress: train_torque(bench, options, on_progress), json_file)


def _speeds(text: str) -> tuple[float, ...]:
    try:
        speeds = tuple(float(part) for part in text.split(","))
    except ValueError:
        raise Failure(f"--speeds: numbers with commas between are wanted, such as 1,3,5,7, not '{text}'") from None
    rising = len(speeds) > 1 and all(low < high for low, high in pairwise(speeds))
    if not (rising and speeds[0] > 0.0 and speeds[-1] <= _FASTEST_RAD_S):
        wanted = f"at least two rising speeds above 0 and up to {_FASTEST_RAD_S:g}"
        raise Failure(f"--speeds: {wanted} rad/s are wanted, such as 1,3,5,7, not '{text}'")
    return speeds
