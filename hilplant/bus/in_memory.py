"""A bus in memory, for plants and ECUs in virtual time."""

from collections import deque

from hilplant.bus.frame import Frame
from hilplant.bus.interface import SendResult


class InMemoryBus:
    """A bus without delay: what one end sends, all others have at once."""

    def __init__(self) -> None:
        self.ends: list[BusEnd] = []

    def end(self) -> "BusEnd":
        """Return a new end: a transport."""
        self.ends.append(BusEnd(self))
        return self.ends[-1]


class BusEnd:
    """One end of the bus; see `bus.interface.Transport`."""

    up, missed = True, 0

    def __init__(self, bus: InMemoryBus) -> None:
        self._bus = bus
        self.coming: deque[Frame] = deque()

    def receive(self, limit: int) -> list[Frame]:
        """Return what has come."""
        if not self.coming:
            return []
        return [self.coming.popleft() for _ in range(min(limit, len(self.coming)))]

    def receive_late(self, limit: int) -> list[tuple[Frame, int | None]]:
        """Return what has come; nothing ever waits here."""
        return [(frame, 0) for frame in self.receive(limit)]

    def send(self, frame: Frame) -> SendResult:
        """Give a frame to all others."""
        for end in self._bus.ends:
            if end is not self:
                end.coming.append(frame)
        return SendResult.SENT

    def reopen(self) -> bool:
        """Say that it is open."""
        return True

    def close(self) -> None:
        """Nothing is open."""
