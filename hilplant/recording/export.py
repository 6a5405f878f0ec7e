"""Converts a recording to what other tools read: tables of signals, or logs of frames."""

from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hilplant.atomic_write import whole_file
from hilplant.failure import Failure
from hilplant.recording import frame_logs
from hilplant.recording.format import INPUT_COLUMNS, OUTPUT_COLUMNS, STATUS_COLUMNS
from hilplant.recording.mf4_frames import append_frames
from hilplant.recording.reader import Recording, read_recording
from hilplant.recording.tables import TableError, check_ending, fill_table
from hilplant.signals import INPUTS, OUTPUTS, STATUS
from hilplant.units import SECOND_NS

TABLE_ENDINGS = (".mf4", ".csv", ".parquet")


def export(path: str | PathLike[str], out: str | PathLike[str]) -> str:
    """Write the recording `path` to `out` by its ending, and return one line that says what was written.

    .csv and .parquet hold every signal by tick, .blf and .asc every frame, .mf4 both. A failure leaves no half file.

    Raises
    ------
    Failure
        When the ending is another one, or a file cannot be read or written.
    """
    out = Path(out)
    ending = out.suffix.lower()
    if ending not in TABLE_ENDINGS + frame_logs.ENDINGS:
        known = ", ".join(TABLE_ENDINGS + frame_logs.ENDINGS)
        raise Failure(f"{out}: the ending must be one of {known}")
    if not out.parent.is_dir():
        raise Failure(f"{out}: cannot be written: there is no folder {out.parent}")
    try:
        if ending in TABLE_ENDINGS:
            check_ending(out)
        recording = read_recording(path)
        with whole_file(out) as passing:
            written = _write(recording, passing, ending)
    except TableError as error:
        raise Failure(str(error)) from error
    except OSError as error:
        raise Failure(f"{out}: cannot be written: {error.strerror or error}") from error
    return "; ".join([f"{out}: {written}", *recording.notes])


def _write(recording: Recording, out: Path, ending: str) -> str:
    if ending in frame_logs.ENDINGS:
        return f"{frame_logs.write_frame_log(recording, out)} frames"
    columns, units = signal_columns(recording)
    if ending == ".mf4":  # one clock for signals and frames, also where periods were lost
        columns = {"deadline_s": columns.pop("deadline_s"), **columns}
    fill_table(out, columns, units)
    ticks = f"{len(columns['time_s'])} ticks of {len(columns) - 1} signals"
    return f"{ticks}, {append_frames(recording, out)} frames" if ending == ".mf4" else ticks


def signal_columns(recording: Recording) -> tuple[dict[str, NDArray[np.float64]], dict[str, str]]:
    """Return all signals by tick, and their units: outputs by their name, ``in_...``, ``status_...``."""
    table = recording.table(["tick", "deadline_ns", *OUTPUT_COLUMNS, *INPUT_COLUMNS, *STATUS_COLUMNS])
    table = table.filter(table.column("deadline_ns").is_valid())
    columns = {"time_s": table.column("tick").to_numpy() * recording.run.step_ns / SECOND_NS}
    units = {"time_s": "s"}
    for prefix, signals, names in (
        ("", OUTPUTS, OUTPUT_COLUMNS),
        ("in_", INPUTS, INPUT_COLUMNS),
        ("status_", STATUS, STATUS_COLUMNS),
    ):
        for signal, name in zip(signals, names, strict=True):
            columns[prefix + signal.name] = table.column(name).to_numpy()
            units[prefix + signal.name] = signal.unit
    columns["deadline_s"] = table.column("deadline_ns").to_numpy() / SECOND_NS
    units["deadline_s"] = "s"
    return columns, units
