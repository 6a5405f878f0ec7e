"""The command line of what is fitted to a bench's physical plant: `hilplant train ...`."""

from itertools import pairwise
from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.options import DEFAULT, BenchName, JsonFile, claim, write_json
from hilplant.failure import Failure

train_app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Fit fast stand-ins to a bench's physical plant, each with a report of its errors.",
    epilog="Example: hilplant train torque default --out trained",
)

#: No wiper's crank turns faster: two hundred wipes a minute.
_FASTEST_RAD_S = 21.0

Out = Annotated[Path, typer.Option(help="folder for the trained file, the report and its plots")]
Seed = Annotated[int, typer.Option(min=0, help="where all random numbers begin; the same seed gives the same file")]


@train_app.command("tables", epilog="Example: hilplant train tables default --bound 1e-8 --out tables")
def train_tables(
    bench: BenchName = DEFAULT,
    bound: Annotated[float, typer.Option(min=1e-10, max=1.0, help="largest error, by the largest value")] = 1e-8,
    out: Out = Path("trained-tables"),
    json_file: JsonFile = None,
) -> None:
    """Tabulate positions, velocities and accelerations, section 6.2.

    With as few knots as keep all of them within a bound.
    """
    from hilplant.train.command import train_tables as run

    claim(json_file)
    write_json(json_file, run(bench, bound, out))


@train_app.command("polynomial", epilog="Example: hilplant train polynomial linkage_alone --out polynomial")
def train_polynomial(
    bench: BenchName = DEFAULT,
    out: Out = Path("trained-polynomial"),
    json_file: JsonFile = None,
) -> None:
    """Fit the no-load torque of the linkage, section 6.3.

    Two polynomials and two constants, by the costs (6.4) and (6.5).
    """
    from hilplant.train.command import train_polynomial as run

    claim(json_file)
    write_json(json_file, run(bench, out))


@train_app.command("torque", epilog="Example: hilplant train torque default --out trained --seed 1")
def train_torque(  # noqa: PLR0913, PLR0917
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
    out: Out = Path("trained-torque"),
    json_file: JsonFile = None,
) -> None:
    """Train the torque network of the whole wiper, section 6.4.2.

    Ctrl-C keeps the best so far. Exit code 1 when a random run finds it beyond the bound that its file states.
    """
    from hilplant.train.command import Wish, study_torque
    from hilplant.train.command import train_torque as run

    claim(json_file)
    wish = Wish(neurons, harmonics, starts, _speeds(speeds), seed, scenarios, out)
    if study:
        write_json(json_file, study_torque(bench, wish, 20))
        return
    kept, figures = run(bench, wish)
    write_json(json_file, figures)
    raise typer.Exit(0 if kept else 1)


@train_app.command("motor", epilog="Example: hilplant train motor default --out trained --seed 1")
def train_motor(
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
    from hilplant.train.motor_command import run_train_motor

    claim(json_file)
    kept, figures = run_train_motor(bench, seed, scenarios, out)
    write_json(json_file, figures)
    raise typer.Exit(0 if kept else 1)


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
