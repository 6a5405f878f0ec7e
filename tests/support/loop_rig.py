"""The default bench's loop in virtual time on an interface made of lists, so that faults come at known ticks."""

from collections import deque

from hilplant.bench import load_bench
from hilplant.bus.frame import Frame
from hilplant.bus.transport import SendResult
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.loop import Loop
from hilplant.runtime.server import build_loop
from hilplant.signals import PUBLISHED_INDEX

RELAY, SUPPLY, ENVIRONMENT, BLADES, MOTOR_STATUS, LINKAGE, FORCES = 0x120, 0x121, 0x122, 0x123, 0x200, 0x202, 0x204
BETWEEN_OTHERS = (0x110, 0x130)  # from the stalk to the ECU and back
SLOW, OFF = Frame(RELAY, b"\x01\x00"), Frame(RELAY, b"\x00\x00")
OWN = (0x200, 0x201, 0x202, 0x203, 0x204, 0x205, 0x210, 0x211, 0x212, 0x213, 0x214, 0x215, 0x216)
STALK_COMMAND, ECU_STATUS = 0x110, 0x130  # between ECU and driver: none of the plant's business
STEP_NS = 1_000_000
TIMEOUT_TICKS = 500


class ListedTransport:
    """An interface whose frames are lists, and which can be taken down or filled up."""

    def __init__(self) -> None:
        self.up = True
        self.missed = 0
        self.full = False
        self.can_reopen = True
        self.reopened = 0
        self.arrived: deque[Frame] = deque()
        self.waited_ns: deque[int | None] = deque()  # of what has arrived; 0 where nothing is left of it
        self.sent: list[Frame] = []

    def receive(self, limit: int) -> list[Frame]:
        if not self.up:
            return []
        return [self.arrived.popleft() for _ in range(min(limit, len(self.arrived)))]

    def send(self, frame: Frame) -> SendResult:
        if not self.up:
            return SendResult.DOWN
        if self.full:
            return SendResult.FULL
        self.sent.append(frame)
        return SendResult.SENT

    def receive_late(self, limit: int) -> list[tuple[Frame, int | None]]:
        return [(frame, self.waited_ns.popleft() if self.waited_ns else 0) for frame in self.receive(limit)]

    def reopen(self) -> bool:
        self.reopened += 1
        self.up = self.can_reopen
        return self.up

    def close(self) -> None:
        self.up = False


class Rig:
    """The default bench's loop on a listed transport, ticked by hand."""

    def __init__(self) -> None:
        self.bench = load_bench("default")
        self.transport = ListedTransport()
        self.loop: Loop = build_loop(self.bench, self.transport, VirtualClock())
        self.now = 0

    def tick(self, ticks: int = 1, *frames: Frame, command_every: int = 0) -> None:
        """Tick on; `frames` come with the first tick, a slow command every so many ticks."""
        self.transport.arrived.extend(frames)
        for _ in range(ticks):
            if command_every and self.now % command_every == 0:
                self.transport.arrived.append(SLOW)
            self.loop.tick(self.now * STEP_NS)
            self.now += 1

    def value(self, name: str) -> float:
        return self.loop._published[PUBLISHED_INDEX[name]]

    def counts(self) -> dict[str, int]:
        return {name: count for name, count in self.loop.counts().items() if count and name != "tick"}
