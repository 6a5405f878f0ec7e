"""The frames of a recording by message, as they had come until a moment in it."""

from collections import deque
from typing import Any

import numpy as np
import pyarrow as pa

from hilplant.arrays import Whole
from hilplant.bench import Bench
from hilplant.operator_page.frames import MOST_PERIODS, FrameKey, FrameTable, Heard
from hilplant.runtime.frame_slot import ERROR, REMOTE
from hilplant.units import SECOND_NS


class RecordedFrames(FrameTable):
    """All frames of a recording; `look` says until when they are shown."""

    def __init__(self, bench: Bench, frames: pa.StructArray) -> None:
        """Take the frames in the order in which they were seen, as a recording has them."""
        super().__init__(bench)
        times_ns, identifiers = (frames.field(name).to_numpy() for name in ("time_ns", "identifier"))
        extended, sent, remote, error = (_flags(frames, name) for name in ("extended", "sent", "remote", "error"))
        contents, flags = frames.field("data").to_pylist(), remote * REMOTE + error * ERROR
        _, which = np.unique(identifiers.astype(np.int64) * 4 + extended * 2 + sent, return_inverse=True)
        self._messages_of: dict[FrameKey, tuple[Whole, list[bytes], Whole]] = {}
        for number in range(int(which.max()) + 1 if len(which) else 0):
            places = np.flatnonzero(which == number)
            key = int(identifiers[places[0]]), bool(extended[places[0]]), bool(sent[places[0]])
            self._messages_of[key] = times_ns[places], [contents[place] for place in places], flags[places]

    def look(self, time_s: float) -> None:
        """Show the frames that had come at this time."""
        self.heard = {}
        for key, (times_ns, contents, flags) in self._messages_of.items():
            count = int(np.searchsorted(times_ns, time_s * SECOND_NS, side="right"))
            if count:
                periods = deque(np.diff(times_ns[max(0, count - MOST_PERIODS - 1) : count]).tolist(), MOST_PERIODS)
                last = count - 1
                self.heard[key] = Heard(count, int(times_ns[last]), contents[last], int(flags[last]), periods)


def _flags(frames: pa.StructArray, name: str) -> Any:
    return frames.field(name).to_numpy(zero_copy_only=False).astype(np.int64)
