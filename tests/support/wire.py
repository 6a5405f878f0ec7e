"""An interface whose other end is the test."""

from hilplant.bus.frame import Frame
from hilplant.bus.transport import SendResult


class Wire:
    """Gives the frames in `arriving`, keeps what is sent."""

    up = True
    missed = 0

    def __init__(self) -> None:
        self.arriving: list[Frame] = []
        self.sent: list[Frame] = []
        self.closed = False

    def receive(self, limit: int) -> list[Frame]:
        arrived, self.arriving = self.arriving[:limit], self.arriving[limit:]
        return arrived

    def send(self, frame: Frame) -> SendResult:
        self.sent.append(frame)
        return SendResult.SENT

    def receive_late(self, limit: int) -> list[tuple[Frame, int | None]]:
        return [(frame, 0) for frame in self.receive(limit)]

    def reopen(self) -> bool:
        return True

    def close(self) -> None:
        self.closed = True
