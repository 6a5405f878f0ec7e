"""Recordings that the page was given: kept in a folder, looked at, cut, and named as the commands name them."""

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.identify.twin import write_csv
from hilplant.measurements.checks import examine
from hilplant.measurements.columns import parse_columns
from hilplant.measurements.files import ENDINGS, Origin, read_channels
from hilplant.measurements.frames import frame_source
from hilplant.measurements.measurement import Measurement
from hilplant.measurements.preparation import Preparation, read_measurement

#: Points of a curve that a page draws at most.
MOST_POINTS = 2000

#: What reads the frames of a CAN log, and what a motor is made of, see `hilplant motor`.
DATABASES, READINGS = (".dbc", ".arxml", ".kcd", ".sym", ".cdd"), (".yaml", ".yml")

_NAME = re.compile(r"[\w .()+-]{1,100}")


def kept(folder: Path, name: str, content: bytes) -> Path:
    """Keep a file that the page was given under its own name; one of the same name is replaced.

    Raises
    ------
    Failure
        For a name that is none, or an ending that nobody reads.

    """
    plain, endings = Path(name).name, (*ENDINGS, *DATABASES, *READINGS)
    if not _NAME.fullmatch(plain) or plain.startswith(".") or Path(plain).suffix.lower() not in endings:
        raise Failure(f"'{name}' is no name of a recording; the ending must be one of {', '.join(endings)}")
    path = folder / plain
    path.write_bytes(content)
    return path


def columns_of(path: Path, frames: str | None = None) -> list[dict[str, str]]:
    """Return the channels of a file with the units that it states."""
    channels = read_channels(Origin(path, None, frame_source(frames)))
    return [{"name": name, "unit": channel.unit} for name, channel in channels.items()]


def looked_at(path: Path, columns: str = "", mode: str | None = None, frames: str | None = None) -> dict[str, Any]:
    """Return what a recording shows: voltage, current, park staircase (Figures 5-2, 5-3), and all that is wrong."""
    data = _read(path, columns, mode, frames)
    rows = thinned(len(data))
    return {
        "samples": len(data),
        "seconds": float(data.time_s[-1] - data.time_s[0]),
        "time_s": data.time_s[rows],
        "voltage_v": data.voltage_v[rows],
        "current_a": data.current_a[rows],
        "park_steps": data.park_steps[rows],
        "notes": list(data.notes),
        "findings": [{"text": each.text, "fatal": each.fatal} for each in examine(data)],
    }


def named_files(folder: Path, endings: Sequence[str] = ENDINGS) -> list[dict[str, str]]:
    """Return the names of the files that were given with one of these endings."""
    return [{"name": path.name} for path in sorted(folder.iterdir()) if path.suffix.lower() in endings]


def cut(
    path: Path, span_s: tuple[float, float], columns: str = "", mode: str | None = None, frames: str | None = None
) -> Path:
    """Write the part of a recording between two times as a file of its own, in SI units.

    Raises
    ------
    Failure
        When less than a second would be left.

    """
    data = _read(path, columns, mode, frames)
    inside = (data.time_s >= span_s[0]) & (data.time_s <= span_s[1])
    if np.count_nonzero(inside) * data.period_s < 1.0:
        raise Failure(f"{path.name}: between {span_s[0]:g} and {span_s[1]:g} s there is less than a second of data")
    parts = {name: getattr(data, name)[inside] for name in ("voltage_v", "current_a", "park", "fast", "valid")}
    shorter = replace(data, time_s=data.time_s[inside] - data.time_s[inside][0], **parts)
    out = path.with_name(f"{path.stem}_{span_s[0]:g}_{span_s[1]:g}.csv")
    write_csv(out, shorter)
    return out


def thinned(count: int) -> Floats:
    """Return the rows that are drawn of so many."""
    return np.unique(np.linspace(0, count - 1, min(count, MOST_POINTS)).astype(np.intp))


def _read(path: Path, columns: str, mode: str | None, frames: str | None) -> Measurement:
    origin = Origin(path, None, frame_source(frames))
    return read_measurement(origin, parse_columns(columns), Preparation(mode=mode or None))
