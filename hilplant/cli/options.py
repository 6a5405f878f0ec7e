"""Arguments that several commands share, and how their figures are written."""

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from hilplant.failure import Failure

BenchName = Annotated[str, typer.Argument(help="a bench file, or the name of a shipped bench", metavar="BENCH")]
Seconds = Annotated[
    float | None, typer.Option(min=0.001, max=1e9, help="end after this time; without it, on Ctrl-C or SIGTERM")
]
JsonFile = Annotated[Path | None, typer.Option("--json", help="write the figures to this file")]
Channel = Annotated[str | None, typer.Option(help="use this channel instead of the bench's, such as can0")]

DEFAULT = "default"


def flat(record: dict[str, Any]) -> dict[str, Any]:
    """Lift nested figures to the top, as `outer_inner`."""
    flat: dict[str, Any] = {}
    for key, value in record.items():
        if isinstance(value, dict):
            flat.update({f"{key}_{inner}": figure for inner, figure in value.items()})
        else:
            flat[key] = value
    return flat


def claim(path: Path | None) -> None:
    """Refuse a file that cannot be written before something long begins."""
    if path is not None:
        _write(path, "")


def write_json(path: Path | None, figures: dict[str, Any]) -> None:
    """Write figures to a file, if there is one."""
    if path is not None:
        _write(path, json.dumps(figures, indent=2, default=str) + "\n")


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise Failure(f"{path}: cannot be written ({error.strerror})") from error
