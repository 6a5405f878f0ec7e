"""All ticks, frames and events of a run in virtual time, kept in memory; stands where the ring would."""

import numpy as np

from hilplant.arrays import Floats, Records
from hilplant.bus.frame import Frame
from hilplant.runtime.commands import COMMAND_DTYPE, ChannelCommand
from hilplant.runtime.frame_slot import FRAME_DTYPE
from hilplant.runtime.row import ROW_WIDTH


class Tape:
    """Takes what a ring takes, and keeps it."""

    lost = recording = 0

    def __init__(self) -> None:
        self._rows, self.ticks = np.zeros((4096, ROW_WIDTH)), 0
        self.frames: list[tuple[int, int, Frame, bool]] = []
        self.events: list[ChannelCommand] = []

    def next_row(self) -> Floats:
        """Return the row to fill."""
        row: Floats = self.next_rows(1)[0]
        return row

    def next_rows(self, count: int) -> Floats:
        """Return the rows to fill."""
        while self.ticks + count > len(self._rows):
            self._rows = np.concatenate([self._rows, np.zeros_like(self._rows)])
        return self._rows[self.ticks : self.ticks + count]

    def commit(self, count: int = 1) -> None:
        """Keep the rows."""
        self.ticks += count

    def write_frame(self, tick: int, bus_ns: int, frame: Frame, sent: bool) -> None:
        """Keep a frame."""
        self.frames.append((tick, bus_ns, frame, sent))

    def read_rows(self) -> Floats:
        """Return all rows."""
        return self._rows[: self.ticks]

    def read_frames(self) -> Records:
        """Return all frames as the ring holds them."""
        found = np.zeros(len(self.frames), FRAME_DTYPE)
        for index, (tick, bus_ns, frame, sent) in enumerate(self.frames):
            flags = sum(flag << bit for bit, flag in enumerate((sent, *frame[2:])))
            data = frame.data.ljust(64, b"\0")
            found[index] = (tick, bus_ns, frame.identifier, flags, len(frame.data), 0, list(data))
        return found

    def read_events(self) -> Records:
        """Return all events as the ring holds them."""
        return np.array([tuple(event) for event in self.events], COMMAND_DTYPE)
