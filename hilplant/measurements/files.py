"""Reads measured channels from what rigs leave behind: recordings, MF4, CSV, Parquet, and CAN logs with a database."""

import hashlib
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hilplant.failure import Failure
from hilplant.measurements.channels import Channels
from hilplant.measurements.columns import KNOWN_NAMES, Column, clock_of, has_unit, text_columns, unit_scale
from hilplant.measurements.frames import FrameSource
from hilplant.measurements.measurement import Channel

if TYPE_CHECKING:
    from hilplant.measurements.csv_table import Table

LOGS = (".blf", ".asc", ".log", ".trc")
#: A name of the time that ends with its unit.
_TIME = re.compile(r"(t|time|zeit|timestamps?)[ _](?P<unit>ms|us|ns|s|min)", re.IGNORECASE)
ENDINGS = (".hilrec", ".csv", ".txt", ".parquet", ".mf4", ".mdf", *LOGS)


class Origin(NamedTuple):
    """Where measured channels come from.

    `time` is the column of the time in a table. CAN frames need a database (its signals are the columns) or a bench
    (the plant's signals are the columns, through the bench's own mapping).
    """

    path: Path
    time: Column | None = None
    frames: FrameSource = FrameSource()


class NoTime(Failure):
    """Nothing says which of the `columns` of a table is the time."""

    def __init__(self, path: Path, table: "Table") -> None:
        """Keep the columns, and say how a command line names one of them."""
        self.columns, self.texts = tuple(table.columns), table.texts
        told = f"{', '.join(self.columns)}{text_columns(self.texts)}"
        super().__init__(f"{path}: no column for the time; say --columns time=NAME[unit] with one of {told}")


def read_channels(origin: Origin) -> Channels:
    """Read every channel of a file, by its ending.

    Raises
    ------
    Failure
        When the ending is unknown or the file cannot be read; it names file and line where there is one.

    """
    if (files := parts(origin.path)) != [origin.path]:
        return _joined(origin, files)
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


def parts(path: Path) -> list[Path]:
    """Return the files that a name stands for: several, that are joined by their time, are written A+B."""
    names = str(path).split("+")
    return [path] if path.exists() or len(names) < 2 or not all(names) else [Path(name) for name in names]


def _joined(origin: Origin, files: list[Path]) -> Channels:
    """Read files of one time, one channel or more in each; a channel is called by its file: ``C1.Ampl``."""
    found: dict[str, Channel] = {}
    notes: list[str] = []
    for path in files:
        channels = read_channels(origin._replace(path=path))
        found |= {f"{path.stem}.{name}": _as_sent(channel) for name, channel in channels.items()}
        notes += channels.notes
    return Channels(found, notes)


def _as_sent(channel: Channel) -> Channel:
    """Take a channel of two values at its changes alone, as a logic analyser writes it, as held until the next one."""
    distances = np.diff(channel.time_s)
    changes = len(distances) > 1 and float(np.max(distances)) > 3.0 * float(np.min(distances))
    return replace(channel, held=True) if changes and set(channel.values.tolist()) <= {0.0, 1.0} else channel


def _ending(path: Path) -> str:
    ending = path.suffix.lower()
    inner = Path(path.stem).suffix.lower()
    return inner if ending == ".gz" and inner in LOGS else ending


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file's content, which a result carries so that its data can be told."""
    digest = hashlib.sha256()
    for part in parts(path):
        with open(part, "rb") as file:
            while block := file.read(1 << 20):
                digest.update(block)
    return digest.hexdigest()


def _recording(origin: Origin) -> Channels:
    from hilplant.recording.export import signal_columns
    from hilplant.recording.reader import read_recording

    columns, units = signal_columns(read_recording(origin.path))
    return _on_one_clock(columns.pop("time_s"), columns, units)


def _csv(origin: Origin) -> Channels:
    from hilplant.measurements.csv_table import read_csv

    table = read_csv(origin.path)
    units = table.units
    columns = {name: values for name, values in table.columns.items() if units[name].lower() != "sequence"}
    clock = clock_of(origin.time) or (None if origin.time or _time_of(columns, units) else table.clock)
    if clock is not None:
        count = len(next(iter(columns.values())))
        return _on_one_clock(clock[0] + clock[1] * np.arange(count), columns, units, table.texts)
    return _table(origin, table._replace(columns=columns))


def _parquet(origin: Origin) -> Channels:
    from hilplant.measurements.parquet_table import read_parquet

    return _table(origin, read_parquet(origin.path))


def _table(origin: Origin, table: "Table") -> Channels:
    """Take the time out of a table, in seconds; rows without a time are an error."""
    columns, units = table.columns, table.units
    column = origin.time or _time_of(columns, units)
    if column is None:
        raise NoTime(origin.path, table)
    if column.name not in columns:
        text = f"no column '{column.name}'; say --columns time=NAME[unit] with one of {', '.join(columns)}"
        raise Failure(f"{origin.path}: {text}{text_columns(table.texts)}")
    unit = column.unit if column.unit is not None else units.get(column.name, "")
    place = f"{origin.path}, column '{column.name}'"
    time_s = np.asarray(columns[column.name]) * unit_scale(place, "time", unit) * column.factor
    if (bad := np.flatnonzero(~np.isfinite(time_s))).size:
        row, others = table.first_line + bad[0], f", nor have {len(bad) - 1} others" if len(bad) > 1 else ""
        raise Failure(f"{origin.path}:{row}: the row has no time{others}; leave out rows without one")
    rest = {name: values for name, values in columns.items() if name != column.name}
    return _on_one_clock(time_s, rest, units, table.texts)


def _time_of(columns: Mapping[str, Any], units: Mapping[str, str]) -> Column | None:
    """Return the column that is called time and in no other unit, else the only one in a unit of time.

    The unit may stand in the name, as in `t_ms`.
    """
    timed = [Column(name) for name in columns if units.get(name) and has_unit("time", units[name])]
    ends = {name: found["unit"] for name in columns if not units.get(name) and (found := _TIME.fullmatch(name))}
    timed += [Column(name, unit.lower()) for name, unit in ends.items()]
    fit = [name for name in columns if not units.get(name) or Column(name) in timed]
    words = (Column(name) for word in KNOWN_NAMES["time"] for name in fit if name.lower() == word)
    return next(words, timed[0] if len(timed) == 1 else None)


def _on_one_clock(
    time_s: Any, columns: Mapping[str, Any], units: Mapping[str, str], texts: Mapping[str, str] | None = None
) -> Channels:
    found = {name: _whole(Channel(time_s, each, units.get(name, ""))) for name, each in columns.items()}
    return Channels(found, texts=texts)


def _whole(channel: Channel) -> Channel:
    """Take a column of two values whose cells are empty but where it changes as held until the next one."""
    there = channel.values[np.isfinite(channel.values)]
    at_changes = 0 < len(there) < len(channel.values) and set(there.tolist()) <= {0.0, 1.0} and np.all(np.diff(there))
    return replace(channel, held=True) if at_changes else channel


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
