"""What a node remembers of each message between two ticks; what the message is, is in `bus/codec.py`."""

from collections.abc import Sequence

from hilplant.bus.codec import ReceivedMessage, SentMessage
from hilplant.bus.protection import Checker, Protector


class Incoming:
    """A received message with what the node remembers of it."""

    def __init__(self, message: ReceivedMessage) -> None:
        self.message = message
        self.checker = Checker(message.protection) if message.protection else None
        self.valid_ns: int | None = None
        self.late = False
        self.is_missing = True  # as last judged

    def is_lost(self, now_ns: int) -> bool:
        """Whether no valid frame has come within the timeout."""
        return self.valid_ns is None or now_ns - self.valid_ns > self.message.timeout_ns


class Outgoing:
    """A sent message with when it is due next and what it carried last."""

    def __init__(self, message: SentMessage) -> None:
        self.message = message
        self.protector = Protector(message.protection) if message.protection else None
        self.due_ns = message.offset_ns
        self.last: tuple[float, ...] | None = None

    def is_due(self, now_ns: int, values: Sequence[float]) -> bool:
        """Whether to send now, by the period or by a change; asked once in a tick, because it moves both on."""
        message = self.message
        changed = False
        if message.on_change:
            watched = tuple([values[index] for index in message.on_change])
            changed = watched != self.last
            self.last = watched
        if message.period_ns and now_ns >= self.due_ns:
            late = now_ns - self.due_ns
            self.due_ns += message.period_ns * (1 + late // message.period_ns)
            return True
        return changed
