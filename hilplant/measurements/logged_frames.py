"""Data frames of a log that python-can reads, with the channel as the log itself names it."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from hilplant.measurements.frames import FrameSource, LoggedFrame, LoggedFrames

if TYPE_CHECKING:
    from hilplant.recording.read_logs import LogReading


def logged_frames(path: Path, source: FrameSource) -> LoggedFrames:
    """Return the data frames of a log; the database gives identifiers to the names that an ASC file may have."""
    from hilplant.recording.read_logs import LogReading

    log = LogReading(path, _names(source))
    return LoggedFrames(_frames(log), log.notes)


def _names(source: FrameSource) -> dict[str, int]:
    if source.database is None:
        return {}
    from hilplant.bus.database import load_database
    from hilplant.recording.text_logs import EXTENDED

    messages = load_database(source.database).messages
    return {message.name: message.frame_id | (EXTENDED * message.is_extended_frame) for message in messages}


def _frames(log: "LogReading") -> Iterator[LoggedFrame]:
    first = 1 if log.ending in (".asc", ".blf") else 0  # there python-can counts channels from 0, the files from 1
    for message in log:
        if message.is_error_frame or message.is_remote_frame:
            continue
        channel = message.channel
        named = str(channel + first) if isinstance(channel, int) else str(channel or "")
        yield LoggedFrame(message.timestamp, message.arbitration_id, message.is_extended_id, bytes(message.data), named)
