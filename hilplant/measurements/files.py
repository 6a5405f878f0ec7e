"""Reads measured channels from what rigs leave behind: recordings, MF4, CSV, Parquet, and CAN logs with a database."""

import hashlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from hilplant.failure import Failure
from hilplant.measurements.channels import Channels
from hilplant.measurements.columns import KNOWN_NAMES, Column, unit_scale
from hilplant.measurements.frames import FrameSource
from hilplant.measurements.measurement import Channel

LOGS = (".blf", ".asc", ".log", ".trc")
ENDINGS = (".hilrec", ".csv", ".txt", ".parquet", ".mf4", ".mdf", *LOGS)


class Origin(NamedTuple):
    """Where measured channels come from.

    `time` is the column of the time in a table. CAN frames need a database (its signals are the columns) or a bench
    (the plant's signals are the columns, through the bench's own mapping).
    """

    path: Path
    time: Column | None = None
    frames: FrameSource = FrameSource()


def read_channels(origin: Origin) -> Channels:
    """Read every channel of a file, by its ending.

    Raises
    ------
    Failure
        When the ending is unknown or the file cannot be read; it names file and line where there is one.

    """
    ending = _ending(origin.path)
    if ending not in ENDINGS:
        raise Failure(f"{origin.path}: the ending must be one of {', '.join(ENDINGS)}")
    if origin.path.is_dir():
        raise Failure(f"{origin.path}: cannot be read: it is a folder")
    if not origin.path.is_file():
        raise Failure(f"{origin.path}: cannot be read: there is no such file")
    try:
        channels = _READERS[ending](origin)
    except OSError as error:
        raise Failure(f"{origin.path}: cannot be read: {(error.strerror or str(error)).lower()}") from error
    if not channels:
        raise Failure(f"{origin.path}: holds no channels")
    return channels


def _ending(path: Path) -> str:
    ending = path.suffix.lower()
    inner = Path(path.stem).suffix.lower()
    return inner if ending == ".gz" and inner in LOGS else ending


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file's content, which a result carries so that its data can be told."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _recording(origin: Origin) -> Channels:
    from hilplant.recording.export import signal_columns
    from hilplant.recording.reader import read_recording

    columns, units = signal_columns(read_recording(origin.path))
    return _on_one_clock(columns.pop("time_s"), columns, units)


def _csv(origin: Origin) -> Channels:
    from hilplant.measurements.csv_table import read_csv

    table = read_csv(origin.path)
    return _table(origin, table.columns, table.units, table.first_line)


def _parquet(origin: Origin) -> Channels:
    import pyarrow as pa
    from pyarrow import parquet

    try:
        table = parquet.read_table(origin.path)
    except pa.ArrowInvalid as error:
        raise Failure(f"{origin.path}: not a Parquet file: {str(error).splitlines()[0]}") from error
    columns, units = {}, {}
    for field in table.schema:
        try:
            columns[field.name] = np.asarray(table.column(field.name).to_numpy(), np.float64)
        except (ValueError, TypeError):
            continue  # a column of text or dates is no channel
        units[field.name] = (field.metadata or {}).get(b"unit", b"").decode()
    return _table(origin, columns, units, 1)


def _table(origin: Origin, columns: Mapping[str, Any], units: Mapping[str, str], first_line: int) -> Channels:
    """Take the time out of a table, in seconds; rows without a time are an error."""
    column = origin.time or next(
        (Column(name) for word in KNOWN_NAMES["time"] for name in columns if name.lower() == word), None
    )
    if column is None or column.name not in columns:
        wanted = f"'{column.name}'" if column else "for the time"
        text = f"no column {wanted}; say --columns time=NAME[unit] with one of {', '.join(columns)}"
        raise Failure(f"{origin.path}: {text}")
    unit = column.unit if column.unit is not None else units.get(column.name, "")
    place = f"{origin.path}, column '{column.name}'"
    time_s = np.asarray(columns[column.name]) * unit_scale(place, "time", unit) * column.factor
    if (bad := np.flatnonzero(~np.isfinite(time_s))).size:
        raise Failure(f"{origin.path}:{first_line + bad[0]}: the row has no time")
    rest = {name: values for name, values in columns.items() if name != column.name}
    return _on_one_clock(time_s, rest, units)


def _on_one_clock(time_s: Any, columns: Mapping[str, Any], units: Mapping[str, str]) -> Channels:
    return Channels({name: Channel(time_s, values, units.get(name, "")) for name, values in columns.items()})


def _mf4(origin: Origin) -> Channels:
    from hilplant.measurements.can_log import read_can_log
    from hilplant.measurements.mf4 import read_mf4_channels, read_mf4_frames

    if origin.frames == FrameSource():
        return read_mf4_channels(origin.path)
    return read_can_log(origin.path, read_mf4_frames(origin.path), origin.frames)


def _can_log(origin: Origin) -> Channels:
    from hilplant.measurements.can_log import read_can_log
    from hilplant.measurements.logged_frames import logged_frames

    return read_can_log(origin.path, logged_frames(origin.path, origin.frames), origin.frames)


_READERS: dict[str, Callable[[Origin], Channels]] = {
    ".hilrec": _recording,
    ".csv": _csv,
    ".txt": _csv,
    ".parquet": _parquet,
    ".mf4": _mf4,
    ".mdf": _mf4,
    **dict.fromkeys(LOGS, _can_log),
}
