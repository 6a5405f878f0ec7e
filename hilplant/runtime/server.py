"""The daemon: opens the bus, starts the recorder, asks for real time, and runs the loop until it is told to end."""

import signal
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

from hilplant.bus.codec import ReceivedMessage, SentMessage
from hilplant.bus.link import LinkSettings
from hilplant.bus.node import Node
from hilplant.bus.transport import Transport, open_transport
from hilplant.faults.acting import ActingFaults
from hilplant.runtime.clock import Clock, WallClock, clock_at
from hilplant.runtime.loop import Late, Loop, PlantRows
from hilplant.runtime.ring import Ring
from hilplant.runtime.scheduling import Privilege, real_time
from hilplant.runtime.watchdog import Watchdog
from hilplant.units import MICROSECOND_NS, MILLISECOND_NS, SECOND_NS


class ServedLoop(Protocol):
    """What the bench says about the loop."""

    @property
    def on_overrun(self) -> str:
        """count, degrade or stop."""

    @property
    def lost_time(self) -> float:
        """Share of a second beyond which the loop counts as behind."""

    @property
    def priority(self) -> int:
        """SCHED_FIFO priority."""

    @property
    def cpu(self) -> int | None:
        """CPU to stay on."""

    @property
    def frames_per_tick(self) -> int:
        """Most frames taken from the bus in a tick."""

    @property
    def queue_frames(self) -> int:
        """Most frames that wait for a full interface."""

    @property
    def reopen_ms(self) -> tuple[int, int]:
        """First and longest pause between attempts to reopen the interface."""


class ServedBench(PlantRows, Protocol):
    """What the server needs of a bench."""

    @property
    def interface(self) -> dict[str, Any]:
        """Arguments that open the CAN interface."""

    @property
    def receive(self) -> tuple[ReceivedMessage, ...]:
        """Messages that command the plant."""

    @property
    def send(self) -> tuple[SentMessage, ...]:
        """Messages that show the plant."""

    @property
    def others(self) -> frozenset[tuple[int, bool]]:
        """Identifiers of messages between others, with whether they are extended."""

    @property
    def sources(self) -> Mapping[str, str]:
        """Texts of the bench's files, the database among them."""

    @property
    def pace(self) -> float:
        """Seconds of the plant in a second of the clock."""

    @property
    def loop(self) -> ServedLoop:
        """Settings of the loop."""


@dataclass(slots=True)
class Summary:
    """What a run came to."""

    ticks: int = 0
    overruns: int = 0
    latency_p50_us: float = 0.0
    latency_p99_us: float = 0.0
    latency_p999_us: float = 0.0
    latency_max_us: float = 0.0
    stopped_by_overrun: bool = False
    fell_behind: bool = False
    recording_complete: bool = True
    controller_stopped: bool = False
    scenario_ruling: str = ""
    first_tick_monotonic_ns: int = 0
    counts: dict[str, int] = field(default_factory=dict)
    out_of_range: dict[str, float] = field(default_factory=dict)
    privileges: list[Privilege] = field(default_factory=list)

    @property
    def is_sound(self) -> bool:
        """Whether the run was what it was to be: in time as the bench wants it, recorded without a gap, and passed."""
        if self.scenario_ruling not in ("", "pass"):
            return False
        return self.recording_complete and not (self.stopped_by_overrun or self.fell_behind or self.controller_stopped)


class StopRequest:
    """Becomes true when somebody wants the run to end."""

    def __init__(self) -> None:
        self.wanted = False

    def __call__(self) -> bool:
        """Say whether the end was asked for."""
        return self.wanted

    def ask(self, *_: object) -> None:
        """Ask for the end; also a signal handler."""
        self.wanted = True


@contextmanager
def ended_by_signals(stop: StopRequest) -> Iterator[None]:
    """Let SIGTERM, SIGINT and the end of the terminal ask for the end instead of breaking a tick in two.

    A signal that is ignored already, as `nohup` does with SIGHUP, stays so.
    """
    numbers = [signal.SIGTERM, signal.SIGINT, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else [])]
    before = {number: signal.getsignal(number) for number in numbers}
    caught = {number: handler for number, handler in before.items() if handler != signal.SIG_IGN}
    for number in caught:
        signal.signal(number, stop.ask)
    try:
        yield
    finally:
        for number, handler in caught.items():
            signal.signal(number, handler)


def link_settings(loop: ServedLoop) -> LinkSettings:
    """Return how the bench wants its interface treated."""
    first_ms, longest_ms = loop.reopen_ms
    return LinkSettings(loop.frames_per_tick, loop.queue_frames, first_ms * MILLISECOND_NS, longest_ms * MILLISECOND_NS)


def build_node(bench: ServedBench, transport: Transport) -> Node:
    """Wire a bench's messages and an open interface into a node."""
    values = [float(value) for value in bench.input_row]
    settings = replace(link_settings(bench.loop), others=bench.others)
    return Node(bench.receive, bench.send, transport, settings, values)


def build_loop(bench: ServedBench, transport: Transport, clock: Clock, ring: Ring | None = None) -> Loop:
    """Wire a bench, an open interface and a clock into a loop."""
    return Loop(bench, build_node(bench, transport), clock, ring, Late(bench.loop.on_overrun, bench.loop.lost_time))


def serve(  # noqa: PLR0913, PLR0917
    bench: ServedBench,
    seconds: float | None = None,
    ring: Ring | None = None,
    stop: StopRequest | None = None,
    on_start: Callable[[list[Privilege]], None] | None = None,
    prepare: Callable[[Loop], None] | None = None,
) -> Summary:
    """Run the bench on its interface on the clock, at its pace; returns after `seconds` of it, a signal, or `stop`.

    With a `ring` the loop takes the commands of its mailbox. `prepare` gets the loop before its first tick, for a
    controller inside it.

    Raises
    ------
    TransportError
        When the interface cannot be opened; nothing has started then.

    """
    stop = stop or StopRequest()
    ticks = None if seconds is None else round(seconds * SECOND_NS / bench.step_ns)
    transport, clock = open_transport(bench.interface), clock_at(bench.pace)
    try:
        acting = ActingFaults(bench, transport)
        loop = build_loop(bench, acting.transport if ring is not None else transport, clock, ring)
        if ring is not None:
            loop.listen(ring.mailbox, ring.events.append, acting)
        if prepare is not None:
            prepare(loop)
        loop.warm_up()
        watchdog = Watchdog(bench.pace)
        with ended_by_signals(stop), real_time(bench.loop.priority, bench.loop.cpu) as privileges:
            if on_start is not None:
                on_start(privileges)
            watchdog.ready()
            if not stop():  # not even the last tick of a run that was ended before it began
                loop.run(ticks, stop, watchdog)
            watchdog.stopping()
    finally:
        transport.close()
    return _summary(loop, clock, privileges)


def _summary(loop: Loop, clock: WallClock, privileges: list[Privilege]) -> Summary:
    latency = loop.latency
    return Summary(
        ticks=loop.progress.ticks,
        overruns=loop.progress.overruns,
        latency_p50_us=latency.quantile_us(0.5),
        latency_p99_us=latency.quantile_us(0.99),
        latency_p999_us=latency.quantile_us(0.999),
        latency_max_us=latency.worst_ns / MICROSECOND_NS,
        stopped_by_overrun=loop.progress.stopped_by_overrun,
        fell_behind=loop.lost_time.exceeded,
        controller_stopped=loop.control_stopped,
        first_tick_monotonic_ns=clock.monotonic_ns(loop.progress.first_tick_ns),
        counts=loop.counts(),
        out_of_range=loop.rejected(),
        privileges=privileges,
    )
