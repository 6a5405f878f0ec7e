"""A stretch of a recording: what was due from one time on and before another, counted from the start of the loop."""

import math
from itertools import count
from typing import BinaryIO, NamedTuple

import numpy as np
import pyarrow as pa

from hilplant.units import SECOND_NS


class Span(NamedTuple):
    """From one time [s], included, to another, which is not."""

    from_s: float = 0.0
    to_s: float = math.inf

    @property
    def is_all(self) -> bool:
        """Whether nothing is left out."""
        return self == (0.0, math.inf)

    def cut(self, rows: pa.RecordBatch) -> pa.RecordBatch:
        """Return the rows within; where the row of a tick was lost, the time of its frames counts."""
        if self.is_all or not len(rows):
            return rows
        within = self._within(_times_ns(rows))
        return rows if within.all() else rows.filter(pa.array(within))

    def ends_before(self, rows: pa.RecordBatch) -> bool:
        """Whether all of these rows, which follow each other in time, and all after them, are left out."""
        return bool(self.to_s < math.inf and len(rows) and self.ends_by(int(_times_ns(rows.slice(0, 1))[0])))

    def begins_after(self, time_ns: int) -> bool:
        """Whether what was due before this time is left out."""
        return time_ns <= self.from_s * SECOND_NS

    def ends_by(self, time_ns: int) -> bool:
        """Whether what was due at this time, and all after it, is left out."""
        return time_ns >= self.to_s * SECOND_NS

    def _within(
        self, times_ns: np.ndarray[tuple[int], np.dtype[np.int64]]
    ) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        return (times_ns >= self.from_s * SECOND_NS) & (times_ns < self.to_s * SECOND_NS)


EVERYTHING = Span()


def begin_of(file: BinaryIO, span: Span) -> tuple[int, int]:
    """Return place [bytes] and number of the block of an Arrow stream with which reading a span has to begin.

    On the way there nothing is decoded but when the ticks were due. Damage ends the way: who reads on names it.
    """
    due = pa.ipc.open_stream(file).schema.get_field_index("deadline_ns")
    begin = file.tell(), 0
    file.seek(0)
    stream = pa.ipc.open_stream(file, options=pa.ipc.IpcReadOptions(included_fields=[due]))
    try:
        for number in count():
            place = file.tell()
            deadlines = stream.read_next_batch().column(0).drop_null()
            if len(deadlines) and not span.begins_after(deadlines[0].as_py()):
                break
            if len(deadlines):
                begin = place, number
    except (StopIteration, pa.ArrowException, OSError, ValueError):
        pass
    return begin


def _times_ns(rows: pa.RecordBatch) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    deadlines = rows.column("deadline_ns")
    times: np.ndarray[tuple[int], np.dtype[np.int64]] = deadlines.fill_null(0).to_numpy(zero_copy_only=False).copy()
    for at in np.flatnonzero(~deadlines.is_valid().to_numpy(zero_copy_only=False)):
        seen = rows.column("frames")[int(at)] or rows.column("events")[int(at)]
        times[at] = seen[0]["time_ns"].as_py()
    return times
