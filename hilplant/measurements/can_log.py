"""CAN frames of a log -> channels, through a bus database or through the mapping of a bench."""

import shlex
from collections import defaultdict
from pathlib import Path

import numpy as np

from hilplant.failure import Failure
from hilplant.measurements.channels import Channels
from hilplant.measurements.frame_readers import Key, Reader, readers_of
from hilplant.measurements.frames import FrameSource, LoggedFrames
from hilplant.measurements.measurement import Channel

#: Frames of several buses are put in order; a time that jumps back by more begins another log [s].
LONGEST_DISORDER_S = 1.0


class _Message:
    """What was read of the frames of one message, and on which channels of the log they came."""

    def __init__(self, reader: Reader) -> None:
        self.reader = reader
        self.times: dict[str, list[float]] = defaultdict(list)
        self.values: dict[str, list[float]] = defaultdict(list)
        self.buses: set[str] = set()
        self.skipped, self.reason = 0, ""

    def take(self, time_s: float, data: bytes) -> None:
        try:
            found = list(self.reader.read(data))
        except ValueError as error:
            self.skipped, self.reason = self.skipped + 1, self.reason or str(error)
            return
        for name, value in found:
            self.times[name].append(time_s)
            self.values[name].append(value)


def read_can_log(path: Path, log: LoggedFrames, source: FrameSource) -> Channels:
    """Read the signals of every known frame of a log; each channel has the times of its own frames.

    A frame that its message cannot read is skipped, and a note says so.

    Raises
    ------
    Failure
        Without a database and without a bench; when no frame of the log is in them; when a message comes on several
        channels of the log, or from two logs behind one another.

    """
    if source.database is None and source.bench is None:
        raise Failure(f"{path}: frames need a database or a bench with a mapping: --frames FILE.dbc or --frames BENCH")
    messages, disorder = _taken(path, log, source)
    _refuse_several_buses(path, messages, source)
    notes = [*log.notes, *_skips(messages)]
    notes += [f"{disorder} frames are earlier than the one before: put in order by their time"] * (disorder > 0)
    read = [message for message in messages.values() if message.times]
    if not read:
        channel = f" on channel {source.channel}" if source.channel else ""
        text = f"{path}: none of its frames{channel} is in {source}; is it the right one?"
        raise Failure("; ".join([text, *notes]))
    start_s = min(min(stamps) for message in read for stamps in message.times.values())
    channels: dict[str, Channel] = {}
    for message in read:
        for name, stamps in message.times.items():
            times, values = np.array(stamps) - start_s, np.array(message.values[name])
            if disorder:
                order = np.argsort(times, kind="stable")
                times, values = times[order], values[order]
            unit = message.reader.units.get(name, "")
            channels.setdefault(message.reader.named(name), Channel(times, values, unit, held=True))
    return Channels(channels, notes)


def _taken(path: Path, log: LoggedFrames, source: FrameSource) -> tuple[dict[Key, _Message], int]:
    """Return what was read by identifier, and how many frames are out of order."""
    readers = readers_of(source)
    messages: dict[Key, _Message] = {}
    disorder, latest_s = 0, -np.inf
    for frame in log.frames:
        if source.channel is not None and frame.channel != source.channel:
            continue
        try:
            reader = readers.of(frame)
        except Failure as error:
            raise Failure(f"{path}, {source}: {error}") from error
        if reader is None:
            continue
        if not np.isfinite(frame.time_s):
            raise Failure(f"{path}: a frame of {reader.message} has no time")
        if frame.time_s < latest_s:
            disorder += 1
            if frame.time_s < latest_s - LONGEST_DISORDER_S:
                text = f"the time jumps back from {latest_s:.6f} to {frame.time_s:.6f} s: two logs in one file; cut it"
                raise Failure(f"{path}: {text} there")
        latest_s = max(latest_s, frame.time_s)
        key = frame.identifier, frame.extended
        message = messages.get(key) or messages.setdefault(key, _Message(reader))
        message.buses.add(frame.channel)
        message.take(frame.time_s, frame.data)
    return messages, disorder


def _refuse_several_buses(path: Path, messages: dict[Key, _Message], source: FrameSource) -> None:
    for (identifier, _), message in messages.items():
        if len(message.buses) > 1:
            buses = sorted(message.buses)
            text = f"{message.reader.message} (0x{identifier:X}) comes on channels {' and '.join(buses)}"
            raise Failure(f"{path}: {text}; say which one: --frames {shlex.quote(f'{source}@{buses[0]}')}")


def _skips(messages: dict[Key, _Message]) -> list[str]:
    return [
        f"{message.skipped} frames of {message.reader.message} (0x{identifier:X}) skipped: {message.reason}"
        for (identifier, _), message in messages.items()
        if message.skipped
    ]
