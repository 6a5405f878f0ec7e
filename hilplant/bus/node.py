"""One participant on the bus: takes in frames, supervises them, and sends its own when they are due.

The plant server and the stand-in ECU are both such nodes. Time comes in as an argument; nothing here sleeps, and
nothing that happens on the bus leaves as an exception.
"""

import math
from collections import deque
from collections.abc import Callable, Sequence

from hilplant.bus.codec import ReceivedMessage, SentMessage
from hilplant.bus.frame import Frame
from hilplant.bus.j1939 import Groups
from hilplant.bus.link import LinkSettings, Reopening
from hilplant.bus.message_state import Incoming, Outgoing, value_fault
from hilplant.bus.protection import FrameCheck
from hilplant.bus.transport import SendResult, Transport
from hilplant.signals import STATUS, STATUS_INDEX
from hilplant.units import MILLISECOND_NS

#: Frames that wait no longer than this, two ticks and what a tick may be late, count as having come now.
_PUNCTUAL_NS = 3 * MILLISECOND_NS
#: How often the interface is asked what it has missed; each time is a system call.
_CENSUS_EVERY_NS = 100 * MILLISECOND_NS


_CAUSES = {
    FrameCheck.WRONG_CRC: "wrong_crc",
    FrameCheck.WRONG_COUNTER: "wrong_counter",
    FrameCheck.NOT_VALID: "e2e_not_valid",
}


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
        self._groups = Groups(m.identifier for m in received if m.j1939)
        self._supervised = [i for i in self._incoming.values() if i.message.timeout_ns]
        self._outgoing = [Outgoing(message) for message in sent]
        self._watched = sorted({index for message in sent for index in message.on_change})
        self._last_watched: list[float] = []
        self._due_ns: float = -math.inf
        self._own = {(m.identifier, m.extended) for m in sent}
        self._emptied_ns: int | None = None  # when nothing was left to be received: what comes later arrived later
        self._pending: deque[Frame] = deque()
        self._reopening = Reopening(transport, settings)
        self._census_ns = 0

    def receive(self, now_ns: int, shed: bool = False) -> None:
        """Take in what has arrived since the last call, then judge what stayed away.

        At most `frames_per_tick` frames are taken, a quarter of them to `shed` load; the rest waits in the interface.
        """
        if self._transport.up:
            self._reopening.was_up = True
        elif self._reopening.goes_down(now_ns):
            self._count("link_down")
        limit = self._settings.frames_per_tick
        limit = max(1, limit // 4) if shed else limit
        if self._emptied_ns is not None and now_ns - self._emptied_ns <= _PUNCTUAL_NS:
            arrivals = [(frame, now_ns) for frame in self._transport.receive(limit)]
        else:
            arrivals = self._late(limit, now_ns)
        for frame, arrived_ns in arrivals:
            if self.observe is not None:
                self.observe(frame, False)
            cause = self._take(frame, arrived_ns, now_ns)
            if cause is not None:
                self._count(cause)
        if len(arrivals) < limit:
            self._emptied_ns = now_ns
        if now_ns >= self._census_ns:
            self._census_ns = now_ns + _CENSUS_EVERY_NS
            self.counts[STATUS_INDEX["missed_frame"]] = self._transport.missed
        self._supervise(now_ns)

    def _late(self, limit: int, now_ns: int) -> list[tuple[Frame, int]]:
        """Receive frames after a stall, and say when each arrived, by its stamp.

        It cannot have been before nothing was left to be received; where the stamp says nothing, suppose it was then.
        """
        emptied_ns = self._emptied_ns
        earliest_ns = -(1 << 62) if emptied_ns is None else emptied_ns
        unknown_ns = now_ns if emptied_ns is None else emptied_ns
        return [
            (frame, unknown_ns if waited_ns is None else max(now_ns - waited_ns, earliest_ns))
            for frame, waited_ns in self._transport.receive_late(limit)
        ]

    def send(self, now_ns: int, values: Sequence[float]) -> None:
        """Send each message that is due, or whose watched signals have changed; `values` by codec order."""
        watched = [values[index] for index in self._watched]
        if now_ns >= self._due_ns or watched != self._last_watched:  # else none of them is due
            self._last_watched = watched
            for outgoing in self._outgoing:
                if outgoing.is_due(now_ns, values):
                    self._pending.append(self._build(outgoing, values))
            self._due_ns = min([each.due_ns for each in self._outgoing], default=math.inf)
        if self._pending:
            self._flush()

    @property
    def send_due_ns(self) -> float:
        """When a message is due if nothing changes."""
        return -math.inf if self._pending else self._due_ns

    def next_loss_ns(self) -> float:
        """Return when a message counts as lost if no frame comes; -inf where a frame waits or the link is down."""
        if self._pending or not (self._reopening.was_up and self._transport.up):
            return -math.inf
        return min((each.lost_at_ns for each in self._supervised if not each.is_missing), default=math.inf)

    def skip(self, now_ns: int) -> None:
        """Take it that up to now nothing has come and no message was lost."""
        self._emptied_ns = now_ns

    def send_all(self, values: Sequence[float]) -> None:
        """Send every message once, due or not: the last word of a node that ends."""
        self._pending.extend([self._build(outgoing, values) for outgoing in self._outgoing])
        self._flush()

    def rejected(self) -> dict[tuple[str, int], float]:
        """Return the last value beyond its limits, by message and target."""
        state = self._incoming.values()
        return {(each.message.name, target): value for each in state for target, value in each.rejected.items()}

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

    def _take(self, frame: Frame, arrived_ns: int, now_ns: int) -> str | None:
        """Apply one frame; a frame that is refused changes nothing, and its cause is returned."""
        identifier, data, extended, fd, _, remote, error = frame
        if error or remote:
            return "error_frame" if error else "remote_frame"
        incoming = self._incoming.get((identifier, extended))
        if incoming is None and extended:
            incoming = self._incoming.get((self._groups.stated(identifier), True))
        if incoming is None:
            return self._foreign((identifier, extended))
        message = incoming.message
        if fd != message.fd or len(data) != message.length:
            return "wrong_length" if fd == message.fd else "fd_frame"
        if incoming.checker is not None:
            verdict = incoming.checker.check(data)
            if verdict is not FrameCheck.OK:
                incoming.refused_ns = arrived_ns
                return _CAUSES[verdict]
        decoded = message.decode(data)
        cause = value_fault(decoded, message.limits)
        if cause is None:
            for target, value in zip(message.targets, decoded):  # noqa: B905 - as in value_fault
                if value is not None:
                    self.values[target] = value
            if incoming.is_stale(arrived_ns, now_ns):
                return "stale_frame"
            self._accept(incoming, decoded, arrived_ns)
        else:
            incoming.reject(decoded)
        return cause

    def _foreign(self, key: tuple[int, bool]) -> str | None:
        """Return what is wrong with a frame that is not for this node."""
        if key in self._own:
            return "own_identifier"
        return None if key in self._settings.others else "unknown_frame"

    def _accept(self, incoming: Incoming, decoded: Sequence[float | None], arrived_ns: int) -> None:
        if incoming.message.timeout_ns and incoming.message.switches and incoming.takes_back(decoded, arrived_ns):
            self._count("alternating")
        if incoming.valid_ns is None or arrived_ns > incoming.valid_ns:
            incoming.valid_ns = arrived_ns
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
                if incoming.checker is not None and incoming.stayed_away(now_ns):
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

    def _count(self, cause: str) -> None:
        self.counts[STATUS_INDEX[cause]] += 1
