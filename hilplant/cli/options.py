"""Arguments that several commands share, and how their figures are written."""

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from hilplant.atomic_write import claim, write_text
from hilplant.extras import need
from hilplant.failure import Failure

BenchName = Annotated[str, typer.Argument(help="a bench file, or the name of a shipped bench", metavar="BENCH")]
Seconds = Annotated[
    float | None, typer.Option(min=0.001, max=1e9, help="end after this time; without it, on Ctrl-C or SIGTERM")
]
JsonFile = Annotated[Path | None, typer.Option("--json", help="write the figures to this file")]
Budget = Annotated[
    int | None,
    typer.Option(min=1, help="processor time a call of your own controller may take; half a period if left out"),
]
Channel = Annotated[str | None, typer.Option(help="use this channel instead of the bench's, such as can0")]
Pace = Annotated[
    float | None,
    typer.Option(
        min=0.001, max=1.0, help="seconds of the plant in a second of the clock, such as 0.1 on a slow machine"
    ),
]

DataNames = Annotated[
    list[str],
    typer.Argument(
        help="recordings, each FILE@dry or FILE@wet, with ,slow or ,fast behind where no column says it",
        metavar="DATA...",
    ),
]
DataName = Annotated[
    str, typer.Argument(help="a recording, FILE, FILE@dry or FILE@wet, with ,slow or ,fast behind", metavar="DATA")
]
BenchOption = Annotated[str, typer.Option("--bench", help="a bench file, or the name of a shipped bench")]
Columns = Annotated[str, typer.Option(help="role=NAME[unit],...: time, voltage, current, park, fast, on")]
Frames = Annotated[str | None, typer.Option(help="bus database, or bench, that reads a log of CAN frames")]
Out = Annotated[Path, typer.Option(help="folder for the trained file, the report and its plots")]
Seed = Annotated[int, typer.Option(min=0, help="where all random numbers begin; the same seed gives the same file")]

DEFAULT = "default"
PICTURES = (".png", ".svg", ".pdf")


def drawable(path: Path) -> Path:
    """Refuse a picture that cannot be written, before any work is done for it."""
    if path.suffix.lower() not in PICTURES:
        raise Failure(f"{path}: the ending must be one of {', '.join(PICTURES)}")
    claim(path)
    need("plot")
    return path


Picture = Annotated[Path, typer.Argument(help=f"picture to write: {', '.join(PICTURES)}", callback=drawable)]


def tabular(path: Path | None) -> Path | None:
    """Refuse a table that cannot be written, before any work is done for it."""
    if path is not None:
        from hilplant.recording.tables import check_ending

        check_ending(path)
        claim(path)
    return path


Table = Annotated[
    Path | None, typer.Option("--table", help="write the numbers too: .csv, .parquet or .mf4", callback=tabular)
]
TurnsAMinute = Annotated[float, typer.Option("--turns", min=0.1, max=300.0, help="of the crank, a minute")]


def write_drawn(path: Path | None, columns: dict[str, Any]) -> None:
    """Write the numbers of a picture, if a file was asked for."""
    if path is not None:
        from hilplant.recording.tables import write_table

        write_table(path, columns, {})
        typer.echo(f"{path} written")


def numbers_of(option: str, text: str) -> tuple[float, ...]:
    """Return numbers with commas between, as an option takes them."""
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise Failure(f"{option}: numbers with commas between are wanted, not '{text}'") from None


def flat(record: dict[str, Any]) -> dict[str, Any]:
    """Lift nested figures to the top, as `outer_inner`."""
    flat: dict[str, Any] = {}
    for key, value in record.items():
        if isinstance(value, dict):
            flat.update({f"{key}_{inner}": figure for inner, figure in value.items()})
        else:
            flat[key] = value
    return flat


def write_json(path: Path | None, figures: dict[str, Any]) -> None:
    """Write figures to a file, if there is one."""
    if path is not None:
        write_text(path, json.dumps(figures, indent=2, default=str) + "\n")
