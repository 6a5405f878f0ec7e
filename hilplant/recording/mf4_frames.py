"""The frames of a recording inside an MF4 file, laid out as ASAM's bus logging wants them."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hilplant.recording.reader import Recording
from hilplant.units import SECOND_NS

#: Name of the event by what kind of frame it is.
EVENTS = {"data": "CAN_DataFrame", "remote": "CAN_RemoteFrame", "error": "CAN_ErrorFrame"}

_FIELDS = (
    ("BusChannel", "u1"),
    ("ID", "<u4"),
    ("IDE", "u1"),
    ("DLC", "u1"),
    ("DataLength", "u1"),
    ("DataBytes", "(64,)u1"),
    ("Dir", "u1"),
    ("EDL", "u1"),
    ("BRS", "u1"),
)
_FD_LENGTHS = (*range(9), 12, 16, 20, 24, 32, 48, 64)


def append_frames(recording: Recording, path: Path) -> int:
    """Add all frames to the MF4 file `path`, whose signals are there already; return how many."""
    from asammdf import MDF, Signal, Source  # an extra

    groups: dict[str, list[dict[str, Any]]] = {kind: [] for kind in EVENTS}
    for rows in recording.batches():
        for frame in rows.column("frames").flatten().to_pylist():
            groups["error" if frame["error"] else "remote" if frame["remote"] else "data"].append(frame)
    bus = Source("CAN", "CAN", "", Source.SOURCE_BUS, Source.BUS_TYPE_CAN)
    with MDF(path) as file:
        for kind, frames in groups.items():
            if frames:
                times = np.array([frame["time_ns"] for frame in frames]) / SECOND_NS
                signal = Signal(_samples(frames, EVENTS[kind]), times, name=EVENTS[kind], source=bus)
                file.append(signal, acq_name="CAN", acq_source=bus, common_timebase=True)
        file.start_time = recording.run.start_utc
        file.save(path, overwrite=True, compression=2)
    return sum(map(len, groups.values()))


def _samples(frames: list[dict[str, Any]], event: str) -> NDArray[np.void]:
    samples = np.zeros(len(frames), [(f"{event}.{name}", kind) for name, kind in _FIELDS])
    for number, frame in enumerate(frames):
        data = frame["data"]
        code = next(code for code, length in enumerate(_FD_LENGTHS) if length >= len(data))
        padded = np.frombuffer(data.ljust(64, b"\0"), np.uint8)
        flags = frame["sent"], frame["fd"], frame["bitrate_switch"]
        samples[number] = (1, frame["identifier"], frame["extended"], code, len(data), padded, *flags)
    return samples
