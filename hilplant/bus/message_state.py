"""What a node remembers of each message between two ticks; what the message is, is in `bus/codec.py`."""

import math
from collections.abc import Sequence

from hilplant.bus.codec import ReceivedMessage, SentMessage
from hilplant.bus.protection import Checker, Protector

#: Within a quarter of its timeout, two and a half cycles by default, nobody changes a command and takes it back.
_AT_ONCE = 4


class Incoming:
    """A received message with what the node remembers of it."""

    def __init__(self, message: ReceivedMessage) -> None:
        self.message = message
        self.checker = Checker(message.protection) if message.protection else None
        self.valid_ns: int | None = None
        self.refused_ns: int | None = None  # when the last frame came that failed its check
        self.late = False
        self.is_missing = True  # as last judged
        self.rejected: dict[int, float] = {}  # the last value beyond its limits, by target
        self._switches: tuple[object, ...] = ()
        self._before: tuple[object, ...] = ()
        self._changed_ns = 0

    def is_lost(self, now_ns: int) -> bool:
        """Whether no valid frame has come within the timeout, or the message is not to be trusted."""
        if self.checker is not None and self.checker.invalid:
            return True
        return self.valid_ns is None or now_ns - self.valid_ns > self.message.timeout_ns

    @property
    def lost_at_ns(self) -> float:
        """When it is lost if no more frame comes."""
        return -math.inf if self.valid_ns is None else self.valid_ns + self.message.timeout_ns + 1

    def stayed_away(self, now_ns: int) -> bool:
        """Whether no frame came at all, so that the next may have any counter; one that stands must not pass so."""
        return self.refused_ns is None or now_ns - self.refused_ns > self.message.timeout_ns

    def is_stale(self, arrived_ns: int, now_ns: int) -> bool:
        """Whether a frame that arrived then is of no use any more."""
        return 0 < self.message.timeout_ns < now_ns - arrived_ns

    def reject(self, decoded: Sequence[float | None]) -> None:
        """Remember which values of a frame were beyond their limits."""
        for target, value, limit in zip(self.message.targets, decoded, self.message.limits, strict=True):
            if value_fault((value,), (limit,)) is not None and value is not None:
                self.rejected[target] = value

    def takes_back(self, decoded: Sequence[float | None], arrived_ns: int) -> bool:
        """Note the flags and choices of a frame, and return whether they undo at once what the frame before changed."""
        switches = tuple([decoded[place] for place in self.message.switches])
        if switches == self._switches:
            return False
        at_once = arrived_ns - self._changed_ns <= self.message.timeout_ns // _AT_ONCE
        undone = at_once and switches == self._before
        self._before, self._switches, self._changed_ns = self._switches, switches, arrived_ns
        return undone


class Outgoing:
    """A sent message with when it is due next and what it carried last."""

    def __init__(self, message: SentMessage) -> None:
        self.message = message
        self.protector = Protector(message.protection) if message.protection else None
        #: Never, for one that is sent when something changes, and then alone.
        self.due_ns: float = message.offset_ns if message.period_ns else math.inf
        self.last: tuple[float, ...] | None = None

    def is_due(self, now_ns: int, values: Sequence[float]) -> bool:
        """Whether to send now, by the period or by a change; asked once in a tick, because it moves both on."""
        message = self.message
        changed = False
        if message.on_change:
            watched = tuple([values[index] for index in message.on_change])
            changed = watched != self.last
            self.last = watched
        if now_ns >= self.due_ns:
            late = now_ns - self.due_ns
            self.due_ns += message.period_ns * (1 + late // message.period_ns)
            return True
        return changed


def value_fault(values: Sequence[float | None], limits: Sequence[tuple[float, float]]) -> str | None:
    """Return what is wrong with decoded values, None if nothing; a value that is absent is not wrong."""
    for value, (lowest, highest) in zip(values, limits):  # noqa: B905 - lengths agree; `strict` costs 0.2 us a call
        if value is not None and not lowest <= value <= highest:
            return "out_of_range" if math.isfinite(value) else "non_finite"
    return None
