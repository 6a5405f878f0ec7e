"""A recorder beside a loop: a ring between them for as long as the loop runs."""

import contextlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple, Protocol

from hilplant.extras import need
from hilplant.recording.recorded_bench import RecordedBench
from hilplant.recording.rotation import Rotation
from hilplant.runtime.ring import Ring
from hilplant.runtime.row import ROW_WIDTH
from hilplant.runtime.server import ServedLoop


class LoopedBench(RecordedBench, Protocol):
    """What the recorder's place beside the loop needs of a bench."""

    @property
    def loop(self) -> ServedLoop:
        """Settings of the loop."""


class RecordTo(NamedTuple):
    """Where to record to, and where its parts end."""

    path: Path
    rotation: Rotation = Rotation()


@contextmanager
def recording(bench: LoopedBench, record: RecordTo | None) -> Iterator[Ring]:
    """Give the loop a ring, which another process drains into files where the run is to be recorded.

    Raises
    ------
    Failure
        At the end, when something of the run was not recorded.
    """
    if record is None:
        with contextlib.closing(Ring.create(ROW_WIDTH)) as ring:  # for all who want to look
            yield ring
            ring.close_writer()
        return
    need("recording")
    from hilplant.recording.recorder import start_recorder

    ring = Ring.create(ROW_WIDTH)
    try:
        recorder = start_recorder(ring, record.path, bench, bench.loop.cpu, record.rotation)
        try:
            yield ring
        finally:
            recorder.finish()
            if not ring.rows_written:  # nothing has started: an empty recording would be in the way of the next attempt
                recorder.remove()
    finally:
        ring.close_writer()
        ring.close()
