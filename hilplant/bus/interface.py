"""What every kind of CAN interface offers to the loop: calls that never block and never raise."""

from enum import Enum
from typing import Protocol

from hilplant.bus.frame import Frame
from hilplant.failure import Failure


class TransportError(Failure):
    """An interface that cannot be opened; says what is there instead, or the command that fixes it."""


class SendResult(Enum):
    """What became of a frame."""

    SENT = "sent"
    FULL = "the interface's queue is full; try again later"
    DOWN = "the interface is down or gone"
    REFUSED = "the interface cannot carry such a frame: an FD frame on a classic interface"


class Transport(Protocol):
    """An open CAN interface."""

    @property
    def up(self) -> bool:
        """Whether frames can pass; once false, `reopen` is needed."""

    @property
    def missed(self) -> int:
        """How many frames the system dropped before they could be received, as far as it tells."""

    def receive(self, limit: int) -> list[Frame]:
        """Return the frames that have arrived, at most `limit`; error frames are marked as such."""

    def receive_late(self, limit: int) -> list[tuple[Frame, int | None]]:
        """Return what `receive` would, each frame with how long it has waited here [ns], None where nobody knows.

        For after a stall; it costs more.
        """

    def send(self, frame: Frame) -> SendResult:
        """Hand a frame over to the interface."""

    def reopen(self) -> bool:
        """Try once to make a lost interface work again; say whether it does; what takes longer goes on beside."""

    def close(self) -> None:
        """Give the interface back."""
