"""How a node treats its interface, and when it opens one that was lost again."""

from dataclasses import dataclass

from hilplant.bus.transport import Transport
from hilplant.units import MILLISECOND_NS


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


class Reopening:
    """Opens a lost interface again, with a pause before each attempt that doubles up to the longest.

    `was_up` is set by the node in each tick in which the interface is up.
    """

    def __init__(self, transport: Transport, settings: LinkSettings) -> None:
        self.was_up = True
        self._transport = transport
        self._first_ns, self._longest_ns = settings.reopen_first_ns, settings.reopen_longest_ns
        self._pause_ns = self._first_ns
        self._due_ns = 0

    def goes_down(self, now_ns: int) -> bool:
        """See to an interface that is down; True in the tick in which it was lost, otherwise it is opened when due."""
        if self.was_up:
            self.was_up = False
            self._pause_ns = self._first_ns
            self._due_ns = now_ns + self._pause_ns
            return True
        if now_ns >= self._due_ns and not self._transport.reopen():
            self._pause_ns = min(2 * self._pause_ns, self._longest_ns)
            self._due_ns = now_ns + self._pause_ns
        return False
