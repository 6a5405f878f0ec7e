"""Converts a recording to what other tools read: tables of signals, or logs of frames."""

from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path

import pyarrow as pa

from hilplant.arrays import Floats
from hilplant.atomic_write import cannot_be_written, claim, whole_file
from hilplant.declaration import Signal
from hilplant.failure import Failure
from hilplant.recording import frame_logs
from hilplant.recording.format import INPUT_COLUMNS, OUTPUT_COLUMNS, STATUS_COLUMNS, schema
from hilplant.recording.mf4_frames import FrameGroups
from hilplant.recording.reader import Recording, read_recording
from hilplant.recording.span import EVERYTHING, Span
from hilplant.recording.tables import check_ending, mf4_group, open_table
from hilplant.signals import INPUTS, OUTPUTS, STATUS
from hilplant.units import SECOND_NS

TABLE_ENDINGS = (".mf4", ".csv", ".parquet", ".mcap")
_SIGNALS: tuple[tuple[str, tuple[Signal, ...], tuple[str, ...]], ...] = (
    ("", OUTPUTS, OUTPUT_COLUMNS),
    ("in_", INPUTS, INPUT_COLUMNS),
    ("status_", STATUS, STATUS_COLUMNS),
)
UNITS = (
    {"time_s": "s"}
    | {prefix + signal.name: signal.unit for prefix, signals, _ in _SIGNALS for signal in signals}
    | {"deadline_s": "s"}
)
#: Rows that are held at once: half a minute, some 15 MB.
_ROWS_AT_ONCE = 30_000

Columns = dict[str, Floats]


def export(path: str | PathLike[str], out: str | PathLike[str], span: Span = EVERYTHING) -> str:
    """Write the recording `path` to `out` by its ending, and return one line that says what was written.

    .csv and .parquet hold every signal by tick, .blf and .asc every frame, .mf4 both. A failure leaves no half file.
    The memory that it takes does not grow with the length of the recording.

    Raises
    ------
    Failure
        When the ending is another one, nothing was recorded within `span`, or a file cannot be read or written.
    """
    out = Path(out)
    ending = out.suffix.lower()
    if ending not in TABLE_ENDINGS + frame_logs.ENDINGS:
        known = ", ".join(TABLE_ENDINGS + frame_logs.ENDINGS)
        raise Failure(f"{out}: the ending must be one of {known}")
    claim(out)
    try:
        if ending in TABLE_ENDINGS:
            check_ending(out)
        recording = read_recording(path).within(span)
        with whole_file(out) as passing:
            written = _write(recording, passing, ending)
    except OSError as error:
        raise cannot_be_written(out, error) from error
    absent = [f"the recording has no {', '.join(recording.missing)}"] if recording.missing else []
    return "; ".join([f"{out}: {written}", *absent, *recording.notes])


def _write(recording: Recording, out: Path, ending: str) -> str:
    if ending in frame_logs.ENDINGS:
        return f"{frame_logs.write_frame_log(recording, out)} frames"
    if ending == ".mf4":
        return _write_mf4(recording, out)
    ticks = 0
    with open_table(out, UNITS) as add:
        for rows in _pieces(recording):
            columns = _columns(rows, recording)
            add(columns)
            ticks += len(columns["time_s"])
    return _told(ticks, recording)


def _write_mf4(recording: Recording, out: Path) -> str:
    import asammdf

    ticks = 0
    with asammdf.MDF(version="4.10") as file:
        add, frames = mf4_group(file, UNITS), FrameGroups(file)
        for rows in _pieces(recording):
            columns = _columns(rows, recording)
            add({"deadline_s": columns.pop("deadline_s"), **columns})  # one clock for signals and frames
            frames.add(rows)
            ticks += len(columns["time_s"])
        file.start_time = recording.run.start_utc
        file.save(out, overwrite=True, compression=2)
    return f"{_told(ticks, recording)}, {frames.count} frames"


def _told(ticks: int, recording: Recording) -> str:
    return f"{ticks} ticks of {len(UNITS) - 1 - len(recording.missing)} signals"


def _pieces(recording: Recording) -> Iterator[pa.Table]:
    """Give the rows in pieces that are worth writing; one without rows where there are none at all."""
    held: list[pa.RecordBatch] = []
    given = False
    for rows in recording.batches():
        held.append(rows)
        if sum(map(len, held)) >= _ROWS_AT_ONCE:
            yield pa.Table.from_batches(held).combine_chunks()
            held, given = [], True
    if held or not given:
        yield pa.Table.from_batches(held, schema()).combine_chunks()


def _columns(rows: pa.Table, recording: Recording) -> Columns:
    rows = rows.filter(rows.column("deadline_ns").is_valid())
    columns = {"time_s": rows.column("tick").to_numpy() * recording.run.step_ns / SECOND_NS}
    for prefix, signals, names in _SIGNALS:
        for signal, name in zip(signals, names, strict=True):
            if name not in recording.missing:
                columns[prefix + signal.name] = rows.column(name).to_numpy()
    columns["deadline_s"] = rows.column("deadline_ns").to_numpy() / SECOND_NS
    return columns


def signal_columns(recording: Recording) -> tuple[Columns, Mapping[str, str]]:
    """Return all signals that there are by tick, and their units: outputs by their name, ``in_...``, ``status_...``."""
    names = [name for name in schema().names if name not in ("frames", "events")]
    return _columns(recording.table(names), recording), UNITS
