"""The command line of identification: `hilplant identify`, `hilplant validate`, `hilplant motor`."""

import datetime
from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.options import DEFAULT, JsonFile, claim, write_json

_DATA_HELP = "recordings, each FILE@dry or FILE@wet, with ,slow or ,fast behind where no column says it"
DataNames = Annotated[list[str], typer.Argument(help=_DATA_HELP, metavar="DATA...")]
BenchOption = Annotated[str, typer.Option("--bench", help="a bench file, or the name of a shipped bench")]
Columns = Annotated[str, typer.Option(help="role=NAME[unit],...: time, voltage, current, park, fast, on")]
Frames = Annotated[str | None, typer.Option(help="bus database, or bench, that reads a log of CAN frames")]


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
    json_file: JsonFile = None,
) -> None:
    """Identify motor and friction from recordings.

    Of a real wiper, with intervals. Three stages: transfer function, global search, least squares. What the data
    cannot tell is named.
    """
    from hilplant.identify.identify_command import Request, identify_files

    for path in (out, report):
        claim_beside(path)
    claim(json_file)
    request = Request(
        tuple(data), bench, out, report, tuple(held_out or ()), tuple(hold or ()), tuple(also or ()), columns, frames,
        optimiser, generations, population, inequalities, seed, resume, dask, date or datetime.date.today().isoformat(),
    )  # fmt: skip
    write_json(json_file, identify_files(request))


def claim_beside(path: Path | None) -> None:
    """Refuse a folder that is not there before something long begins; what is in a file stays until it is replaced."""
    from hilplant.failure import Failure

    if path is not None and not path.resolve().parent.is_dir():
        raise Failure(f"{path}: cannot be written: there is no folder {path.resolve().parent}")


def validate(  # noqa: PLR0913, PLR0917
    data: DataNames,
    bench: BenchOption = DEFAULT,
    rms_current_a: Annotated[float | None, typer.Option(min=0.0, help="bound on the current's error, rms [A]")] = None,
    rms_edge_ms: Annotated[float | None, typer.Option(min=0.0, help="bound on the park edges' error, rms [ms]")] = None,
    columns: Columns = "",
    frames: Frames = None,
    json_file: JsonFile = None,
) -> None:
    """Hold a bench against recordings.

    Errors of current and park edges. Exit code 1 when one is above a bound that was given.
    """
    from hilplant.identify.validate_command import validate_files

    claim(json_file)
    good, figures = validate_files(data, bench, (columns, frames), (rms_current_a, rms_edge_ms))
    write_json(json_file, figures)
    raise typer.Exit(0 if good else 1)


def motor(
    readings: Annotated[Path, typer.Argument(help="readings on a bench, or a data sheet, in YAML", metavar="READINGS")],
    out: Annotated[Path, typer.Option(help="motor file to write")],
    json_file: JsonFile = None,
) -> None:
    """Make a motor file from readings or a data sheet.

    With the standard error of each parameter; docs/identification.md says what the file of readings holds.
    """
    from hilplant.motor_bench.motor_command import motor_from_readings

    claim_beside(out)
    claim(json_file)
    write_json(json_file, motor_from_readings(readings, out))


def add_to(app: typer.Typer) -> None:
    """Add these commands to the command line."""
    app.command(epilog="Example: hilplant motor my_readings.yaml --out my_motor.yaml")(motor)
    app.command(epilog="Example: hilplant identify slow.csv@dry fast.csv@wet --out car.yaml")(identify)
    app.command(epilog="Example: hilplant validate check.csv@dry --bench car.yaml --rms-current-a 0.2")(validate)
