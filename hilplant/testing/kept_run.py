"""What a bench has left so far, tick by tick in memory: evidence for verdicts, and a recording of it."""

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from hilplant.bench import Bench
from hilplant.runtime.commands import COMES, GOES
from hilplant.runtime.row import ROW_WIDTH
from hilplant.runtime.tape import Tape
from hilplant.testing.evidence import Evidence, FaultEdge

#: A run in virtual time has no date.
_NO_DATE = datetime(1970, 1, 1, tzinfo=UTC)


class KeptRun:
    """A bench with the tape of its run."""

    def __init__(self, bench: Bench) -> None:
        self.bench, self.tape = bench, Tape()

    @property
    def start_ns(self) -> int:
        """Time 0 of what is expected."""
        return 0

    @property
    def unfit(self) -> Sequence[int]:
        """Steps that count as lost for another reason than the loop's."""
        return ()

    def evidence(self) -> Evidence:
        """Return what has been so far."""
        frames, step_ns = self.tape.frames, self.bench.step_ns
        places = np.array([bus_ns // step_ns for _, bus_ns, _, _ in frames], np.int64)
        edges = [
            FaultEdge(event.time_ns // step_ns, event.text.decode(), event.kind == COMES)
            for event in self.tape.events
            if event.kind in (COMES, GOES)
        ]
        found = [frame for _, _, frame, _ in frames]
        start = self.start_ns // step_ns
        return Evidence(step_ns, self.tape.read_rows(), places, found, edges, start, hidden=self.unfit)

    def described(self) -> dict[str, str]:
        """Say what a recording says of the run."""
        from hilplant.recording.metadata import describe

        return describe(self.bench, _NO_DATE)

    def record(self, path: Path) -> None:
        """Write what has been so far as a recording, over a file that is there."""
        from hilplant.recording.writer import RecordingWriter

        path.unlink(missing_ok=True)
        writer = RecordingWriter(path, self.described(), ROW_WIDTH)
        writer.add(self.tape.read_rows(), self.tape.read_frames(), self.tape.read_events())
        writer.write(last=True)
        writer.close()
