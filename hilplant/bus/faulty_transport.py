"""Faults of the bus, between a node and its interface: what the node sends and hears is changed, delayed, lost, added.

In front of an interface it is the real bus's fault, in virtual time the in-memory one's. It is there only in a run that
has such faults.
"""

import heapq
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hilplant.bus.frame import Frame
from hilplant.bus.frame_fault import FrameFault, Passing
from hilplant.bus.interface import SendResult, Transport


@dataclass(frozen=True, slots=True)
class PlacedFault:
    """A fault, which way the frames go that it is about, and whether it is there now.

    `others` are frames that it is not about, by identifier and whether that is extended.
    """

    effect: FrameFault
    outgoing: bool
    present: Callable[[], bool]
    others: frozenset[tuple[int, bool]] = frozenset()

    def takes(self, frame: Frame) -> bool:
        """Say whether it is about a frame."""
        return self.effect.target.takes(frame) and (frame.identifier, frame.extended) not in self.others


class _Way:
    """One direction: the faults in their order, and the frames that wait for their time."""

    def __init__(self) -> None:
        self.faults: list[PlacedFault] = []
        self._waiting: list[tuple[int, int, Frame, int | None]] = []
        self._number = 0

    @property
    def idle(self) -> bool:
        """Whether nothing is to be done here: no fault, and no frame that waits."""
        return not (self.faults or self._waiting)

    @property
    def cut_off(self) -> bool:
        """Whether the node that sends this way is off the bus."""
        return any(fault.effect.cuts_off and fault.present() for fault in self.faults)

    def add(self, frame: Frame, now_ns: int, waited_ns: int | None = 0) -> None:
        """Take a frame."""
        self._pass([(frame, 0)], 0, now_ns, waited_ns)

    def add_own(self, now_ns: int) -> None:
        """Take the frames that faults send by themselves; only the faults behind them change them."""
        for index, fault in enumerate(self.faults):
            own = fault.effect.own(now_ns, fault.present())
            if own:
                self._pass([(frame, 0) for frame in own], index + 1, now_ns, 0)

    def due(self, now_ns: int, limit: int) -> list[tuple[Frame, int | None]]:
        """Return the frames whose time has come, oldest first."""
        found: list[tuple[Frame, int | None]] = []
        while self._waiting and self._waiting[0][0] <= now_ns and len(found) < limit:
            _, _, frame, waited_ns = heapq.heappop(self._waiting)
            found.append((frame, waited_ns))
        return found

    def put_back(self, frame: Frame) -> None:
        """Take a frame again that could not be sent; it goes before all others."""
        heapq.heappush(self._waiting, (-1, 0, frame, 0))

    def _pass(self, passing: Passing, first: int, now_ns: int, waited_ns: int | None) -> None:
        for fault in self.faults[first:]:
            passed: Passing = []
            for frame, delay_ns in passing:
                if fault.takes(frame):
                    changed = fault.effect.passing(frame, now_ns + delay_ns, fault.present())
                    passed += [(each, delay_ns + more_ns) for each, more_ns in changed]
                else:
                    passed.append((frame, delay_ns))
            passing = passed
        for frame, delay_ns in passing:
            self._number += 1
            item = (now_ns + delay_ns, self._number, frame, 0 if delay_ns else waited_ns)
            heapq.heappush(self._waiting, item)


class FaultyTransport:
    """A transport with faults before it; see `bus.interface.Transport`."""

    def __init__(self, transport: Transport, faults: Sequence[PlacedFault] = ()) -> None:
        self._transport = transport
        self._in, self._out = _Way(), _Way()
        self._now_ns = 0
        self._spoken: list[Frame] = []
        self.add(faults)

    def add(self, faults: Sequence[PlacedFault]) -> None:
        """Insert more faults; each acts on what those before it let pass."""
        for fault in faults:
            (self._out if fault.outgoing else self._in).faults.append(fault)

    def remove(self, faults: Sequence[PlacedFault]) -> None:
        """Take faults out; frames that they have held back pass in their time."""
        for fault in faults:
            (self._out if fault.outgoing else self._in).faults.remove(fault)

    def begin(self, now_ns: int) -> None:
        """Go on to the next tick; the faults are those of this tick."""
        self._now_ns = now_ns
        self._in.add_own(now_ns)
        self._out.add_own(now_ns)
        self._flush()

    def own_end(self) -> "OwnEnd":
        """Return an end for another sender in this process: its frames go to the bus, and are heard here too."""
        return OwnEnd(self._transport, self._spoken)

    @property
    def idle(self) -> bool:
        """Whether frames only pass through, and none of them waits here."""
        return self._in.idle and self._out.idle and not self._spoken

    @property
    def up(self) -> bool:
        """Whether frames can pass; no longer when the node is off the bus."""
        return self._transport.up and not self._out.cut_off

    @property
    def missed(self) -> int:
        """How many frames the system dropped."""
        return self._transport.missed

    def receive(self, limit: int) -> list[Frame]:
        """Return the frames that have arrived, at most `limit`."""
        if self.idle:
            return self._transport.receive(limit)
        self._hear_own()
        for frame in self._transport.receive(limit):
            self._in.add(frame, self._now_ns)
        return [frame for frame, _ in self._arrived(limit)]

    def receive_late(self, limit: int) -> list[tuple[Frame, int | None]]:
        """Return what has arrived, each frame with how long it has waited; one that was held back has not."""
        self._hear_own()
        for frame, waited_ns in self._transport.receive_late(limit):
            self._in.add(frame, self._now_ns, waited_ns)
        return self._arrived(limit)

    def send(self, frame: Frame) -> SendResult:
        """Take a frame; SENT also where a fault loses or delays it, as the node cannot know."""
        if self._out.idle and self._in.idle:
            return self._transport.send(frame)
        if not self.up:
            return SendResult.DOWN
        before = self._flush()
        if before is SendResult.FULL:
            return before  # not taken, so that the node keeps it
        if not self._in.cut_off:  # else the other end is off the bus
            self._out.add(frame, self._now_ns)
        result = self._flush()
        return SendResult.SENT if result is SendResult.FULL else result

    def reopen(self) -> bool:
        """Try once to make the interface work again; in vain while the node is off the bus."""
        return not self._out.cut_off and (self._transport.up or self._transport.reopen())

    def close(self) -> None:
        """Give the interface back."""
        self._transport.close()

    def _hear_own(self) -> None:
        for frame in self._spoken:
            self._in.add(frame, self._now_ns)
        self._spoken.clear()

    def _arrived(self, limit: int) -> list[tuple[Frame, int | None]]:
        arrived = self._in.due(self._now_ns, limit)
        return [] if self._out.cut_off else arrived

    def _flush(self) -> SendResult:
        """Send what is due; a frame that a full interface does not take waits here."""
        while due := self._out.due(self._now_ns, 1):
            result = self._transport.send(due[0][0])
            if result is SendResult.FULL:
                self._out.put_back(due[0][0])
            if result is not SendResult.SENT:
                return result
        return SendResult.SENT


class OwnEnd:
    """Where another node in this process sends; what it would hear is nobody's."""

    missed = 0

    def __init__(self, transport: Transport, spoken: list[Frame]) -> None:
        self._transport, self._spoken = transport, spoken

    @property
    def up(self) -> bool:
        """Whether frames can pass."""
        return True

    def receive(self, limit: int) -> list[Frame]:
        """Return nothing."""
        return []

    def receive_late(self, limit: int) -> list[tuple[Frame, int | None]]:
        """Return nothing."""
        return []

    def send(self, frame: Frame) -> SendResult:
        """Give a frame to the bus and to the node here, to which it comes also while the interface takes none."""
        self._transport.send(frame)
        self._spoken.append(frame)
        return SendResult.SENT

    def reopen(self) -> bool:
        """Say that it is open."""
        return True

    def close(self) -> None:
        """Nothing is open here."""
