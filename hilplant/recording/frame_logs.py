"""The frames of a recording as python-can messages, and the logs of other tools, written and read: BLF and ASC."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import can

from hilplant.failure import Failure
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


def write_frame_log(recording: Recording, out: Path) -> int:
    """Write all frames by the ending of `out`, one of ``ENDINGS``; return how many.

    BLF holds all that was recorded; ASC has a mere line for an error frame, without its content. Times are
    exact to a microsecond in both.
    """
    count = 0
    with can.Logger(out) as log:
        for message in messages(recording):
            log.on_message_received(message)
            count += 1
    return count


def logged_messages(path: Path) -> Iterator[can.Message]:
    """Give every frame of a BLF or ASC file in its order.

    Raises
    ------
    Failure
        When the file is not such a log, or breaks off within a frame.
    """
    try:
        with can.LogReader(path) as log:
            yield from log
    except OSError as error:
        raise Failure(f"{path}: cannot be read: {error.strerror or error}") from error
    except Exception as error:  # the readers of python-can let errors of every kind through
        raise Failure(f"{path}: cannot be read as a {path.suffix[1:].upper()} log: {error}") from error
