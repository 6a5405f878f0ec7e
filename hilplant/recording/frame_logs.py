"""The frames of a recording as python-can messages, and the logs of other tools that are written: BLF and ASC."""

from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

import can

from hilplant.recording.reader import Recording
from hilplant.units import SECOND_NS

ENDINGS = (".blf", ".asc")


def messages(recording: Recording) -> Iterator[can.Message]:
    """Give every frame in the order in which it was seen; what the plant sent is Tx, what it received Rx."""
    start_s = recording.run.start_utc.timestamp()
    for rows in recording.batches():
        for frame in rows.column("frames").flatten().to_pylist():
            yield _message(frame, start_s + frame["time_ns"] / SECOND_NS)


def _message(frame: dict[str, Any], timestamp_s: float) -> can.Message:
    return can.Message(
        timestamp=timestamp_s,
        arbitration_id=frame["identifier"],
        data=frame["data"],
        is_extended_id=frame["extended"],
        is_fd=frame["fd"],
        bitrate_switch=frame["bitrate_switch"],
        is_remote_frame=frame["remote"],
        is_error_frame=frame["error"],
        is_rx=not frame["sent"],
    )


class _AscOfARun(can.ASCWriter):
    """ASC with the date of the run in its head; python-can writes that of the export, and milliseconds without 0s."""

    def __init__(self, out: Path, start_utc: datetime) -> None:
        self.run_start: datetime | None = start_utc.astimezone().replace(tzinfo=None)
        super().__init__(out)

    def _format_header_datetime(self, dt: datetime) -> str:
        shown = self.run_start or dt
        self.run_start = None  # the head comes first; the block of frames begins with the first of them
        return shown.strftime(f"%a %b %d %H:%M:%S.{shown.microsecond // 1000:03d} %Y")


def write_frame_log(recording: Recording, out: Path) -> int:
    """Write all frames by the ending of `out`, one of ``ENDINGS``; return how many.

    BLF holds all that was recorded; ASC has a mere line for an error frame, without its content. Times are
    exact to a microsecond in both.
    """
    count = 0
    log = can.Logger(out) if out.suffix.lower() != ".asc" else _AscOfARun(out, recording.run.start_utc)
    with log:
        for message in messages(recording):
            log.on_message_received(message)
            count += 1
    return count
