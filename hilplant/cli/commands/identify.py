"""`hilplant identify`."""

import datetime
from pathlib import Path
from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import (
    DEFAULT,
    BenchOption,
    Columns,
    DataNames,
    Frames,
    JsonFile,
    write_json,
)
from hilplant.extras import need
from hilplant.failure import Failure

app = command_app()


@app.command(epilog="Example: hilplant identify slow.csv@dry fast.csv@wet --out car.yaml")
def identify(  # noqa: PLR0913, PLR0917 a command has as many options as it has
    data: DataNames,
    out: Annotated[Path, typer.Option(help="bench file to write; OUT.motor.yaml and OUT.screen.yaml come beside it")],
    bench: BenchOption = DEFAULT,
    report: Annotated[Path | None, typer.Option(help="write a report with pictures, one HTML file")] = None,
    held_out: Annotated[list[str] | None, typer.Option(help="a recording to judge by, not fitted; repeatable")] = None,
    hold: Annotated[list[str] | None, typer.Option(help="keep a parameter, such as force_n=7.6; repeatable")] = None,
    also: Annotated[
        list[str] | None, typer.Option(help="also look for it, such as coulomb_torque_n_m; repeatable")
    ] = None,
    columns: Columns = "",
    frames: Frames = None,
    optimiser: Annotated[str, typer.Option(help="global search: genetic, cma or de")] = "genetic",
    generations: Annotated[int, typer.Option(help="of the global search")] = 200,
    population: Annotated[int, typer.Option(help="of the global search")] = 40,
    inequalities: Annotated[bool, typer.Option(help="keep slow R, L, K above fast ones (3.32), genetic only")] = True,
    seed: Annotated[int, typer.Option(help="of the global search", min=0)] = 0,
    resume: Annotated[bool, typer.Option("--resume", help="go on where a run that was killed had come to")] = False,
    dask: Annotated[str | None, typer.Option(help="evaluate on this Dask scheduler, such as tcp://host:8786")] = None,
    date: Annotated[str | None, typer.Option(help="date in the files; today when left out")] = None,
    stages: Annotated[
        str, typer.Option(help="1 transfer function, 2 global search, 3 least squares; intervals come from 3")
    ] = "1,2,3",
    json_file: JsonFile = None,
) -> None:
    """Identify motor and friction from recordings.

    Of a real wiper, with intervals. Three stages: transfer function, global search, least squares. What the data
    cannot tell is named. A bench with `load: {model: none}` is a motor without linkage (section 5.4.5).
    """
    need("identify")
    from hilplant.cli.actions.identify import run_identification
    from hilplant.identify.from_files import Request
    from hilplant.identify.stages import LEAST_SQUARES, parse_stages

    wanted = parse_stages(stages)
    if report is not None and LEAST_SQUARES not in wanted:
        raise Failure("--report shows intervals and residuals of stage 3: add it to --stages")
    for path in (out, report):
        claim(path)
    claim(json_file)
    request = Request(
        tuple(data), bench, out, tuple(held_out or ()), tuple(hold or ()), tuple(also or ()), columns, frames,
        optimiser, generations, population, inequalities, seed, resume, dask, date or datetime.date.today().isoformat(),
        wanted,
    )  # fmt: skip
    write_json(json_file, run_identification(request, report))
