"""The 1 kHz loop: frames in, one step of the plant, frames out, one row for who looks on.

Deadlines are absolute: tick k is due at start + k * step. A tick that comes a whole period late gives up the periods it
missed, counts them, and goes on with the next deadline; the step itself is never stretched.
"""

from collections.abc import Callable
from dataclasses import dataclass
from struct import Struct
from typing import NamedTuple, Protocol

import numpy as np

from hilplant.arrays import Floats
from hilplant.bus.node import Node
from hilplant.faults.acting import ActingFaults
from hilplant.models.plant import tick as plant_tick
from hilplant.runtime.clock import Clock
from hilplant.runtime.commands import BUS, SAFE_STATE, ChannelCommand
from hilplant.runtime.held_faults import HeldFaults
from hilplant.runtime.intake import Intake
from hilplant.runtime.latency import Latency
from hilplant.runtime.lost_time import LostTime
from hilplant.runtime.mailbox import Mailbox
from hilplant.runtime.ownership import Ownership
from hilplant.runtime.ring import Ring
from hilplant.runtime.row import FIRST_INPUT, FIRST_OUTPUT, FIRST_OWNER, FIRST_STATE, FIRST_STATUS, ROW_WIDTH
from hilplant.runtime.watchdog import Watchdog
from hilplant.signals import INPUTS, MODES, OUTPUT_INDEX, OUTPUTS, STATUS, STATUS_INDEX
from hilplant.units import MICROSECOND_NS, SECOND_NS

WAITING, RUNNING, SAFE, DEGRADED, STOPPED, BEHIND = (float(index) for index in range(len(MODES)))

_TICK, _MODE, _OVERRUNS, _WORST, _RING_LOST, _RECORDING = (
    STATUS_INDEX[name] for name in ("tick", "mode", "overruns", "worst_latency_us", "ring_lost", "recording")
)
_GUARD = OUTPUT_INDEX["guard"]
#: Write lists into a row; numpy takes half as long again.
_WRITE_INPUTS, _WRITE_STATUS = (Struct(f"{len(signals)}d").pack_into for signals in (INPUTS, STATUS))

#: A controller inside the loop: called with time [ns] and the rows of state, inputs and parameters as they are in this
#: tick, it writes its command to the inputs, and says whether it is sound. One that is not is not called again: from
#: then on the safe state is in force.
Control = Callable[[int, Floats, Floats, Floats], bool]


class PlantRows(Protocol):
    """What the loop needs of a bench: the plant as flat rows, and what to do when things go wrong."""

    @property
    def step_ns(self) -> int:
        """Length of a tick."""

    @property
    def parameter_row(self) -> Floats:
        """Packed parameters."""

    @property
    def tables(self) -> Floats:
        """Tables over the crank angle."""

    @property
    def state_row(self) -> Floats:
        """Packed initial state."""

    @property
    def input_row(self) -> Floats:
        """Inputs until something else is said."""

    @property
    def safe(self) -> tuple[tuple[int, float], ...]:
        """Input indices and their values while a command is lost."""


@dataclass(slots=True)
class Progress:
    """Where the loop stands; read by its starter once the loop has ended."""

    ticks: int = 0
    overruns: int = 0
    first_tick_ns: int = 0
    stopped_by_overrun: bool = False


class Late(NamedTuple):
    """What a late tick leads to: `policy` is count, degrade or stop; `lost_time` the share of a second that may go."""

    policy: str = "count"
    lost_time: float = 1.0


class Loop:
    """One plant on one bus, tick by tick."""

    def __init__(self, plant: PlantRows, node: Node, clock: Clock, ring: Ring | None, late: Late) -> None:
        self.progress = Progress()
        self.latency = Latency()
        #: Called in each tick in which no command is lost.
        self.control: Control | None = None
        self.control_stopped = False
        #: The inputs as last commanded; who commands beside the bus writes here, between ticks.
        self.commanded = node.values
        self._plant = plant
        self._node = node
        self._clock = clock
        self._ring = ring
        self._on_overrun = late.policy
        self.lost_time = LostTime(late.lost_time)
        self._degraded_until_ns, self._behind = -1, False
        #: The row of the tick that was done last.
        self.line = np.zeros(ROW_WIDTH)
        self._memory = self.line.data
        self._inputs = self.line[FIRST_INPUT:FIRST_OUTPUT]
        self._outputs = self.line[FIRST_OUTPUT:FIRST_STATUS]
        self._before = self.line[FIRST_STATE:FIRST_OWNER]
        self._owners = self.line[FIRST_OWNER:]
        self._parameters = plant.parameter_row.copy()
        self._ownership = Ownership(node.values, self._owners)
        #: Takes commands at a tick's start; None until :meth:`listen`.
        self.intake: Intake | None = None
        self._was_safe = False
        self._state, self._bus_ns = plant.state_row.copy(), 0
        self._published: list[float] = [0.0] * (len(OUTPUTS) + len(STATUS))
        node.observe = self._observe if ring is not None else None

    def listen(self, mailbox: Mailbox | None, tell: Callable[[ChannelCommand], None], acting: ActingFaults) -> Intake:
        """Take commands and faults at each tick's start, and give answers and events to `tell`."""
        faults = HeldFaults(acting, (self.line, self._parameters), self._node.counts, tell)
        self.intake = Intake(mailbox, self._ownership, faults, tell)
        return self.intake

    def run(self, ticks: int | None, stop: Callable[[], bool], watchdog: Watchdog) -> None:
        """Tick until `ticks` periods have passed (None: for ever), `stop` says so, or the overrun policy ends it."""
        step_ns, feed_ns = self._plant.step_ns, watchdog.period_ns
        start_ns = self._clock.now_ns() + step_ns
        last_ns = start_ns + (ticks - 1) * step_ns if ticks is not None else None
        next_feed_ns = start_ns + feed_ns
        deadline_ns = start_ns
        self.progress.first_tick_ns = start_ns
        while not (stop() or self.progress.stopped_by_overrun):
            self._clock.sleep_until_ns(deadline_ns)
            late_ns = self._clock.now_ns() - deadline_ns
            if late_ns >= step_ns:
                deadline_ns += self._overrun(late_ns // step_ns)
            if last_ns is not None and deadline_ns >= last_ns:
                break
            self.latency.add(late_ns)
            if self._ring is not None:
                self._ring.note_late(late_ns // MICROSECOND_NS)
            self.tick(deadline_ns - start_ns)
            if feed_ns and deadline_ns >= next_feed_ns and not self._behind:
                watchdog.feed()
                next_feed_ns = deadline_ns + feed_ns
            deadline_ns += step_ns
        self._end(deadline_ns - start_ns)

    def tick(self, bus_ns: int) -> None:
        """Do one tick; `bus_ns` is its deadline counted from the loop's start."""
        self._bus_ns = bus_ns
        self._behind = self.lost_time.behind(bus_ns)
        if self.intake is not None:
            self.intake.begin(self.progress.ticks, bus_ns)
        node = self._node
        node.receive(bus_ns, shed=bus_ns < self._degraded_until_ns)
        self._step(safe=node.lost, mode=self._mode(bus_ns))
        node.send(bus_ns, self._published)
        self._record()

    def _step(self, safe: bool, mode: float) -> None:
        if self._take_inputs(safe):
            mode = SAFE
        self._before[:] = self._state
        plant_tick(self._state, self._inputs, self._parameters, self._plant.tables, self._outputs)
        self._published = self._outputs.tolist() + self._status_values(mode)

    def _take_inputs(self, safe: bool) -> bool:
        """Fill in the tick's inputs and their owners; returns whether the controller has just been stopped."""
        _WRITE_INPUTS(self._memory, 8 * FIRST_INPUT, *self._node.values)
        if self._was_safe:
            self._owners[:] = BUS
        if self._ownership.active:
            self._ownership.impose(self._inputs)
        stopped = False
        if not safe and self.control is not None:
            stopped = not self.control(self._bus_ns, self._state, self._inputs, self._parameters)
            self.control_stopped = stopped
            if stopped:
                self.control = None
            if self._ownership.active:
                self._ownership.impose(self._inputs)
        self._was_safe = safe or self.control_stopped
        if self._was_safe:
            for index, value in self._plant.safe:
                self._inputs[index] = value
                self._owners[index] = SAFE_STATE
        return stopped

    def _record(self) -> None:
        if self._ring is not None:
            self.line[0] = self.progress.ticks
            self.line[1] = self._bus_ns
            _WRITE_STATUS(self._memory, 8 * FIRST_STATUS, *self._published[len(OUTPUTS) :])
            self._ring.next_row()[:] = self.line
            self._ring.commit()
        self.progress.ticks += 1

    def _end(self, bus_ns: int) -> None:
        """Do the last tick: relays open, and every message tells that the plant has stopped."""
        self._bus_ns = bus_ns
        self._step(safe=True, mode=STOPPED)
        self._node.send_all(self._published)
        self._record()

    def warm_up(self) -> None:
        """Run every compiled and generated function once, on copies, so that the first tick meets none of them cold."""
        outputs = self._outputs.copy()
        plant_tick(self._state.copy(), self._plant.input_row.copy(), self._parameters, self._plant.tables, outputs)
        self._node.rehearse([*outputs.tolist(), *([0.0] * len(STATUS))])

    def rejected(self) -> dict[str, float]:
        """Return the last value of each input that was out of range, by `Message.input`."""
        return {f"{message}.{INPUTS[target].name}": value for (message, target), value in self._node.rejected().items()}

    def counts(self) -> dict[str, int]:
        """Return the node's counts by cause."""
        status = zip(STATUS, self._status_values(STOPPED), strict=True)
        return {signal.name: value for signal, value in status if signal.kind == "count"}

    def _mode(self, bus_ns: int) -> float:
        if self._outputs[_GUARD] or self.control_stopped:
            return SAFE
        if self._node.lost:
            return WAITING if self._node.waiting else SAFE
        if self._behind:
            return BEHIND
        return DEGRADED if bus_ns < self._degraded_until_ns else RUNNING

    def _status_values(self, mode: float) -> list[int]:
        counts = self._node.counts
        counts[_TICK] = self.progress.ticks
        counts[_MODE] = int(mode)
        counts[_OVERRUNS] = self.progress.overruns
        counts[_WORST] = self.latency.worst_ns // MICROSECOND_NS
        if self._ring is not None:
            counts[_RING_LOST] = self._ring.lost
            counts[_RECORDING] = self._ring.recording
        return counts

    def _overrun(self, periods: int) -> int:
        """Count the periods that were missed and return how far the deadline moves on [ns]."""
        self.progress.overruns += periods
        self.lost_time.add(periods * self._plant.step_ns)
        if self._on_overrun == "stop":
            self.progress.stopped_by_overrun = True
        elif self._on_overrun == "degrade":
            self._degraded_until_ns = self._bus_ns + (periods + 1) * self._plant.step_ns + SECOND_NS
        return periods * self._plant.step_ns

    def _observe(self, frame: object, sent: bool) -> None:
        self._ring.write_frame(self.progress.ticks, self._bus_ns, frame, sent)  # type: ignore[union-attr, arg-type]
