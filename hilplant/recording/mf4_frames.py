"""The frames of a recording inside an MF4 file, laid out as ASAM's bus logging wants them."""

from typing import Any

import numpy as np
import pyarrow as pa

from hilplant.arrays import Records
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


class FrameGroups:
    """The frames in an open MF4 file, a group for each kind; they come piece by piece."""

    def __init__(self, file: Any) -> None:
        self.count = 0
        self._file = file
        self._groups: dict[str, int] = {}

    def add(self, rows: pa.Table) -> None:
        """Add the frames of some rows of a recording."""
        frames: dict[str, list[dict[str, Any]]] = {kind: [] for kind in EVENTS}
        for frame in (frame for seen in rows.column("frames").to_pylist() for frame in seen):
            frames["error" if frame["error"] else "remote" if frame["remote"] else "data"].append(frame)
        for kind, found in frames.items():
            if found:
                self._add(kind, found)
                self.count += len(found)

    def _add(self, kind: str, frames: list[dict[str, Any]]) -> None:
        from asammdf import Signal, Source  # an extra

        times = np.array([frame["time_ns"] for frame in frames]) / SECOND_NS
        samples = _samples(frames, EVENTS[kind])
        if kind in self._groups:
            self._file.extend(self._groups[kind], [(times, None), (samples, None)])
            return
        bus = Source("CAN", "CAN", "", Source.SOURCE_BUS, Source.BUS_TYPE_CAN)
        signal = Signal(samples, times, name=EVENTS[kind], source=bus)
        self._groups[kind] = self._file.append(signal, acq_name="CAN", acq_source=bus, common_timebase=True)


def _samples(frames: list[dict[str, Any]], event: str) -> Records:
    samples = np.zeros(len(frames), [(f"{event}.{name}", kind) for name, kind in _FIELDS])
    for number, frame in enumerate(frames):
        data = frame["data"]
        code = next(code for code, length in enumerate(_FD_LENGTHS) if length >= len(data))
        padded = np.frombuffer(data.ljust(64, b"\0"), np.uint8)
        flags = frame["sent"], frame["fd"], frame["bitrate_switch"]
        samples[number] = (1, frame["identifier"], frame["extended"], code, len(data), padded, *flags)
    return samples
