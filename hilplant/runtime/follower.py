"""Reads along in the ring of a loop, as any number of processes may, without the loop knowing or waiting."""

import numpy as np
from numpy.typing import NDArray

from hilplant.arrays import Floats
from hilplant.runtime.lane import Taken
from hilplant.runtime.ring import Ring


class Follower:
    """One reader of the ring `name`, with places of its own: in rows, events and frames.

    It begins with what is written from now on; with `history` with what the ring still holds, up to a minute.
    """

    def __init__(self, name: str, history: bool = False) -> None:
        """Open the ring.

        Raises
        ------
        FileNotFoundError
            When it is gone.
        ValueError
            When it is of another version of hilplant.
        """
        self._ring = Ring.attach(name)
        lanes = self._ring.row_lane, self._ring.events, self._ring.frame_lane
        self._row_place, self._event_place, self._frame_place = (
            max(0, lane.head - lane.capacity + lane.capacity // 8) if history else lane.head for lane in lanes
        )

    def rows(self) -> Taken:
        """Take what is new: float64 [n, columns] in the order of the loop's row, and how many rows were lost."""
        taken = self._ring.row_lane.since(self._row_place)
        self._row_place = taken.place
        return taken

    def frames(self) -> Taken:
        """Take the frames that are new, received and sent, as an array of ``FRAME_DTYPE``."""
        taken = self._ring.frame_lane.since(self._frame_place)
        self._frame_place = taken.place
        return taken

    def events(self) -> Taken:
        """Take the events that are new, as an array of ``COMMAND_DTYPE``."""
        taken = self._ring.events.since(self._event_place)
        self._event_place = taken.place
        return taken

    def latest(self) -> Floats:
        """Copy the newest row; zeros before the first."""
        return self._ring.latest()

    def late_us(self, ticks: int) -> NDArray[np.int32]:
        """Copy how late [us] the last ticks began, up to so many, the newest last."""
        return self._ring.late_us(ticks)

    @property
    def ended(self) -> bool:
        """Whether the loop has written its last row."""
        return self._ring.writer_closed

    def close(self) -> None:
        """Let go of the ring."""
        self._ring.close()
