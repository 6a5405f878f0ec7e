"""One participant on the bus: takes in frames, supervises them, and sends its own when they are due.

The plant server and the stand-in ECU are both such nodes. Time comes in as an argument; nothing here sleeps, and
nothing that happens on the bus leaves as an exception.
"""

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hilplant.bus.codec import ReceivedMessage, SentMessage
from hilplant.bus.frame import Frame
from hilplant.bus.message_state import Incoming, Outgoing
from hilplant.bus.protection import Verdict
from hilplant.bus.transport import SendResult, Transport
from hilplant.signals import STATUS, STATUS_INDEX
from hilplant.units import MILLISECOND_NS

#: How often the interface is asked what it has missed; each time is a system call.
_CENSUS_EVERY_NS = 100 * MILLISECOND_NS


@dataclass(frozen=True, slots=True)
class LinkSettings:
    """How a node treats its interface.

    `others` are the identifiers, with whether they are extended, of messages that are known to pass between others.
    """

    frames_per_tick: int = 100
    queue_frames: int = 64
    reopen_first_ns: int = 100 * MILLISECOND_NS
    reopen_longest_ns: int = 2000 * MILLISECOND_NS
    others: frozenset[tuple[int, bool]] = frozenset()


class Node:
    """A CAN node that maps frames to signal values and back.

    `values` holds the last valid value of each received signal. `lost` is true while any supervised message has
    not come within its timeout; `waiting` while one of them has not come at all. `counts` follows ``signals.STATUS``;
    the node counts the causes that arise on the bus.
    """

    def __init__(
        self,
        received: Sequence[ReceivedMessage],
        sent: Sequence[SentMessage],
        transport: Transport,
        settings: LinkSettings,
        values: list[float],
    ) -> None:
        self.values = values
        self.counts = [0] * len(STATUS)
        self.lost = self.waiting = any(message.timeout_ns for message in received)
        self.observe: Callable[[Frame, bool], None] | None = None
        self._transport = transport
        self._settings = settings
        self._incoming = {(m.identifier, m.extended): Incoming(m) for m in received}
        self._supervised = [i for i in self._incoming.values() if i.message.timeout_ns]
        self._outgoing = [Outgoing(message) for message in sent]
        self._watched = sorted({index for message in sent for index in message.on_change})
        self._last_watched: list[float] = []
        self._due_ns: float = -math.inf
        self._pending: deque[Frame] = deque()
        self._was_up = True
        self._reopen_ns = 0
        self._census_ns = 0
        self._reopen_pause_ns = settings.reopen_first_ns

    def receive(self, now_ns: int, shed: bool = False) -> None:
        """Take in what has arrived since the last call, then judge what stayed away.

        At most `frames_per_tick` frames are taken, a quarter of them to `shed` load; the rest waits in the interface.
        """
        if not self._transport.up:
            self._reopen(now_ns)
        limit = self._settings.frames_per_tick
        for frame in self._transport.receive(max(1, limit // 4) if shed else limit):
            if self.observe is not None:
                self.observe(frame, False)
            cause = self._take(frame, now_ns)
            if cause is not None:
                self._count(cause)
        if now_ns >= self._census_ns:
            self._census_ns = now_ns + _CENSUS_EVERY_NS
            self.counts[STATUS_INDEX["missed_frame"]] = self._transport.missed
        self._supervise(now_ns)

    def send(self, now_ns: int, values: Sequence[float]) -> None:
        """Send each message that is due, or whose watched signals have changed; `values` by codec order."""
        watched = [values[index] for index in self._watched]
        if now_ns >= self._due_ns or watched != self._last_watched:  # else none of them is due
            self._last_watched = watched
            for outgoing in self._outgoing:
                if outgoing.is_due(now_ns, values):
                    self._pending.append(self._build(outgoing, values))
            self._due_ns = min((each.due_ns for each in self._outgoing if each.message.period_ns), default=math.inf)
        if self._pending:
            self._flush()

    def send_all(self, values: Sequence[float]) -> None:
        """Send every message once, due or not: the last word of a node that ends."""
        self._pending.extend([self._build(outgoing, values) for outgoing in self._outgoing])
        self._flush()

    def silent(self, target: int) -> bool:
        """Whether the message that sets a value has not come within its timeout; one that nobody supervises is not."""
        return any(target in incoming.message.targets for incoming in self._supervised if incoming.is_missing)

    def rehearse(self, values: Sequence[float]) -> None:
        """Encode and decode every message once, without any effect, so that the first tick meets no cold code."""
        for outgoing in self._outgoing:
            outgoing.message.encode(values)
        for incoming in self._incoming.values():
            incoming.message.decode(bytes(incoming.message.length))

    def close(self) -> None:
        """Give the interface back."""
        self._transport.close()

    def _take(self, frame: Frame, now_ns: int) -> str | None:
        """Apply one frame; a frame that is refused changes nothing, and its cause is returned."""
        identifier, data, extended, fd, _, remote, error = frame
        if error or remote:
            return "error_frame" if error else "remote_frame"
        incoming = self._incoming.get((identifier, extended))
        if incoming is None:
            return None if (identifier, extended) in self._settings.others else "unknown_frame"
        message = incoming.message
        if fd != message.fd or len(data) != message.length:
            return "wrong_length" if fd == message.fd else "fd_frame"
        if incoming.checker is not None:
            verdict = incoming.checker.check(data)
            if verdict is not Verdict.OK:
                return "wrong_crc" if verdict is Verdict.WRONG_CRC else "wrong_counter"
        decoded = message.decode(data)
        cause = _value_fault(decoded, message.limits)
        if cause is None:
            self._accept(incoming, decoded, now_ns)
        return cause

    def _accept(self, incoming: Incoming, decoded: Sequence[float | None], now_ns: int) -> None:
        if incoming.checker is not None:
            incoming.checker.accept()
        for target, value in zip(incoming.message.targets, decoded):  # noqa: B905 - as in _value_fault
            if value is not None:
                self.values[target] = value
        incoming.valid_ns = now_ns
        incoming.late = False

    def _supervise(self, now_ns: int) -> None:
        lost = waiting = False
        for incoming in self._supervised:
            incoming.is_missing = incoming.is_lost(now_ns)
            if not incoming.is_missing:
                continue
            lost = True
            if incoming.valid_ns is None:
                waiting = True
            elif not incoming.late:
                incoming.late = True
                self._count("timeout")
                if incoming.checker is not None:
                    incoming.checker.reset()
        self.lost, self.waiting = lost, waiting

    def _build(self, outgoing: Outgoing, values: Sequence[float]) -> Frame:
        message = outgoing.message
        data, saturated = message.encode(values)
        if saturated:
            self.counts[STATUS_INDEX["saturated"]] += saturated
        if outgoing.protector is not None:
            protected = bytearray(data)
            outgoing.protector.protect(protected)
            data = bytes(protected)
        return Frame(message.identifier, data, message.extended, message.fd)

    def _flush(self) -> None:
        """Hand over what waits; when the interface takes no more, the oldest frames beyond the queue are dropped."""
        pending = self._pending
        while pending:
            result = self._transport.send(pending[0])
            if result is SendResult.SENT:
                frame = pending.popleft()
                if self.observe is not None:
                    self.observe(frame, True)
            elif result is SendResult.FULL:
                while len(pending) > self._settings.queue_frames:
                    pending.popleft()
                    self._count("queue_full")
                return
            elif result is SendResult.REFUSED:
                pending.popleft()
                self._count("fd_frame")
            else:
                pending.clear()  # old states are worth nothing once the link is back
                return

    def _reopen(self, now_ns: int) -> None:
        if self._was_up:
            self._was_up = False
            self._count("link_down")
            self._reopen_pause_ns = self._settings.reopen_first_ns
            self._reopen_ns = now_ns + self._reopen_pause_ns
        elif now_ns >= self._reopen_ns:
            if self._transport.reopen():
                self._was_up = True
                return
            self._reopen_pause_ns = min(2 * self._reopen_pause_ns, self._settings.reopen_longest_ns)
            self._reopen_ns = now_ns + self._reopen_pause_ns

    def _count(self, cause: str) -> None:
        self.counts[STATUS_INDEX[cause]] += 1


def _value_fault(values: Sequence[float | None], limits: Sequence[tuple[float, float]]) -> str | None:
    """Return what is wrong with decoded values, None if nothing; a value that is absent is not wrong."""
    for value, (lowest, highest) in zip(values, limits):  # noqa: B905 - lengths agree; `strict` costs 0.2 us a call
        if value is not None and not lowest <= value <= highest:
            return "out_of_range" if math.isfinite(value) else "non_finite"
    return None
