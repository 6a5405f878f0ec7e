"""A plant on a CAN channel, on the clock: the server is a process of its own, and a test follows it tick by tick."""

import contextlib
import sys
from collections import deque
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import numpy as np

from hilplant.bench import Bench
from hilplant.bus.frame import Frame
from hilplant.bus.transport import Transport, open_transport
from hilplant.channel.client import RunChannel
from hilplant.channel.run_files import RunFile
from hilplant.ecu.node import EcuNode
from hilplant.ecu.settings import controller_settings
from hilplant.ecu.vocabulary import Stalk
from hilplant.failure import Failure
from hilplant.faults.timing import Course
from hilplant.faults.written import FaultEntry
from hilplant.recording.recorder import description_now
from hilplant.runtime.clock import WallClock
from hilplant.runtime.commands import ChannelCommand
from hilplant.runtime.follower import Follower
from hilplant.runtime.frame_slot import frame_in
from hilplant.runtime.row import ROW_WIDTH
from hilplant.signals import INPUTS
from hilplant.testing.kept_run import KeptRun
from hilplant.testing.on_interface import LATE_NS, run_of, serving
from hilplant.units import MILLISECOND_NS, SECOND_NS

#: A loop that writes no row for so long has ended or hangs.
_SILENT_NS = 10 * SECOND_NS
_AT_ONCE = 10_000


class ChannelEnd:
    """One end at the channel, with what has come there."""

    def __init__(self, transport: Transport) -> None:
        self.transport = transport
        self.coming: deque[Frame] = deque()

    def send(self, frame: Frame) -> object:
        """Give a frame to the interface."""
        return self.transport.send(frame)


class ClockedBench(KeptRun):
    """A bench whose loop runs by itself; `step` goes on to its next tick, and waits for it where it has not come.

    With `stand_in` the stand-in ECU joins from here. Where a test comes more than 25 ms after a tick, the ticks in
    between are unfit for a verdict, because what the test does comes too late for them.
    """

    def __init__(self, bench: Bench, run: RunFile, channel: str, stand_in: bool) -> None:
        super().__init__(bench)
        self._begun = description_now(bench)
        self._interface, self._clock = bench.at(channel).interface, WallClock()
        self._open, self.bus = ExitStack(), self
        self._channel = self._open.enter_context(RunChannel(run))
        self._follower = self._open.enter_context(contextlib.closing(Follower(run.ring, history=True)))
        self._ends: list[ChannelEnd] = []
        self._ecu: EcuNode | None = None
        if stand_in:
            transport = self._open.enter_context(contextlib.closing(open_transport(self._interface)))
            self._ecu = EcuNode(bench.ecu_side(), transport, controller_settings(bench.ecu))
        self._polled_ns = 0
        self._rows, self._frames = np.zeros((0, ROW_WIDTH)), deque[tuple[int, int, Frame, bool]]()
        self._await_rows()
        self._keep(len(self._rows))
        self._unfit: list[int] = []

    def close(self) -> None:
        """Let go of what is held, of channel and interface."""
        self._open.close()

    def described(self) -> dict[str, str]:
        """Say what a recording says of the run."""
        return self._begun

    def end(self) -> ChannelEnd:
        """Return a new end at the channel."""
        transport = self._open.enter_context(contextlib.closing(open_transport(self._interface)))
        self._ends.append(ChannelEnd(transport))
        return self._ends[-1]

    @property
    def unfit(self) -> list[int]:
        """Steps in which the test was late."""
        return self._unfit

    @property
    def now_ns(self) -> int:
        """The time of the tick behind the one that was seen last."""
        rows = self.tape.read_rows()
        return int(rows[-1, 1]) + self.bench.step_ns if len(rows) else 0

    @property
    def ticks(self) -> int:
        """How many periods have passed."""
        return self.now_ns // self.bench.step_ns

    def step(self, most: int = 1) -> int:
        """Go on by at least one tick and at most so many; returns by how many periods.

        Raises
        ------
        Failure
            When the loop has ended, or is silent for 10 s.

        """
        before = self.ticks
        if not len(self._rows):
            self._await_rows()
        if len(self._rows) * self.bench.step_ns > LATE_NS:
            self._unfit.extend((self._rows[:, 1] / self.bench.step_ns).astype(int).tolist())
        self._keep(most)
        return self.ticks - before

    def run(self, ticks: int) -> None:
        """Let many ticks pass."""
        while ticks > 0:
            ticks -= self.step(ticks)

    def set(self, index: int, value: float) -> None:
        """Set an input of the plant, until a frame carries another value."""
        self._channel.set(INPUTS[index].name, value)

    def insert_fault(self, entry: FaultEntry) -> Course:
        """Insert a fault; its times count from now."""
        self._channel.insert(entry)
        return Course(entry.inserted(self.bench.step_ns / SECOND_NS))

    def end_fault(self, course: Course) -> None:
        """Let a fault go."""
        self._channel.clear(course.inserted.fault.name)

    def _await_rows(self) -> None:
        limit_ns = self._clock.now_ns() + _SILENT_NS
        while not len(self._rows):
            self._take_in()
            if not len(self._rows):
                if self._follower.ended or self._clock.now_ns() > limit_ns:
                    raise Failure("the server has ended, or its loop stands still")
                self._clock.sleep_until_ns(self._clock.now_ns() + MILLISECOND_NS)

    def _take_in(self) -> None:
        """Fetch rows, frames and events; the frames of a row are there before it."""
        self._rows = self._follower.rows().records
        for slot in self._follower.frames().records.tolist():
            self._frames.append((slot[0], slot[1], *frame_in(slot)))
        self.tape.events.extend(ChannelCommand(*event) for event in self._follower.events().records.tolist())
        for end in self._ends:
            end.coming.extend(end.transport.receive(_AT_ONCE))

    def _keep(self, most: int) -> None:
        """Put rows on the tape with their frames, and let the ECU act."""
        kept, self._rows = self._rows[:most], self._rows[most:]
        self.tape.next_rows(len(kept))[:] = kept
        self.tape.commit(len(kept))
        while self._frames and self._frames[0][0] <= kept[-1, 0]:
            self.tape.frames.append(self._frames.popleft())
        if self._ecu is not None and self.now_ns - self._polled_ns >= self.bench.ecu.period_ms * MILLISECOND_NS:
            self._polled_ns = self.now_ns
            self._ecu.poll(self.now_ns, Stalk())


@contextmanager
def clocked_bench(bench: Bench, name: str, channel: str, stand_in: bool) -> Iterator[ClockedBench]:
    """Start a server of this bench on a channel, and follow it; `name` is the bench's for the command line."""
    found: list[RunFile] = []
    command = [sys.executable, "-m", "hilplant", "run", name, "--channel", channel]
    with serving(command, name, lambda: bool(found)) as process:
        run = run_of(process, WallClock())
        if run is not None:
            found.append(run)
            with contextlib.closing(ClockedBench(bench, run, channel, stand_in)) as made:
                yield made
            process.terminate()
