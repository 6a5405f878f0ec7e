"""A bench whose every tick takes two frames in and sends four out, and the peer at the bus' other end."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import cycle, islice
from typing import Any, NamedTuple

from hilplant.bench import Bench, load_bench
from hilplant.bus.codec import SentMessage
from hilplant.bus.frame import Frame
from hilplant.bus.protection import Protector
from hilplant.bus.transport import Transport, open_transport
from hilplant.signals import INPUT_INDEX

FRAMES_IN = 2
FRAMES_OUT = 4
_MOST_FRAMES = 100
_PATIENCE_S = 1.0
_PAUSE_S = 0.001

VIRTUAL: dict[str, Any] = {"interface": "virtual", "channel": "hilplant-perf"}
VCAN: dict[str, Any] = {"interface": "socketcan", "channel": "vcan0"}


class Ends(NamedTuple):
    """The two ends of a bus: the plant's, and that of the one who commands it."""

    plant: Transport
    peer: Transport


@contextmanager
def both_ends(interface: dict[str, Any]) -> Iterator[Ends]:
    """Open both ends of a bus."""
    ends = Ends(open_transport(interface), open_transport(interface))
    try:
        yield ends
    finally:
        for end in ends:
            end.close()


def busy_bench() -> Bench:
    """Return the default bench with as many messages as wanted, each due at every tick and only then."""
    bench = load_bench("default")
    due = [replace(message, period_ns=bench.step_ns, offset_ns=0, on_change=()) for message in bench.send[:FRAMES_OUT]]
    return replace(bench, send=tuple(due))


def silent_bench() -> Bench:
    """Return the default bench without a bus."""
    return replace(load_bench("default"), receive=(), send=())


class Peer:
    """Sends what the plant takes in, message after message, and throws away what the plant sends."""

    def __init__(self, bench: Bench, transport: Transport) -> None:
        """Command a plant on `bench`: slow, at its supply voltage."""
        self._transport = transport
        values = bench.input_row.tolist()
        values[INPUT_INDEX["relay_on"]] = 1.0
        self._commands = cycle([_Command(message, values) for message in bench.ecu_side().send])

    def send(self) -> None:
        """Send the frames of one tick."""
        for command in islice(self._commands, FRAMES_IN):
            self._transport.send(command.frame())

    def drain(self) -> int:
        """Take in all that waits, and return how many frames that was."""
        return len(self._transport.receive(_MOST_FRAMES))

    def take(self, wanted: int) -> int:
        """Take in `wanted` frames, and return how many came: the kernel may deliver them after a while."""
        frames = self.drain()
        give_up = time.monotonic() + _PATIENCE_S
        while frames < wanted and time.monotonic() < give_up:
            time.sleep(_PAUSE_S)
            frames += self.drain()
        return frames


class _Command:
    """A message that says the same for ever, with a counter that moves on where it is protected."""

    def __init__(self, message: SentMessage, values: list[float]) -> None:
        self._message = message
        self._data, _ = message.encode(values)
        self._protector = Protector(message.protection) if message.protection else None

    def frame(self) -> Frame:
        data = bytearray(self._data)
        if self._protector is not None:
            self._protector.protect(data)
        return Frame(self._message.identifier, bytes(data), self._message.extended, self._message.fd)
