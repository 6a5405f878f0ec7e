"""How much time the loop has lost lately: whether what it computes can still be called real time."""

from hilplant.units import SECOND_NS


class LostTime:
    """Time lost in the current second and in the one before it, against what a second may lose."""

    def __init__(self, share: float) -> None:
        """Take the share of a second that may be lost."""
        #: Whether the limit has ever been passed.
        self.exceeded = False
        self._most_ns = share * SECOND_NS
        self._next_ns = SECOND_NS
        self._lost_ns = self._before_ns = 0

    def add(self, lost_ns: int) -> None:
        """Count time that was lost now."""
        self._lost_ns += lost_ns
        self.exceeded = self.exceeded or self._lost_ns > self._most_ns

    def behind(self, now_ns: int) -> bool:
        """Return whether more than the limit was lost in this second or the last one; asked in each tick."""
        if now_ns >= self._next_ns:
            adjoining = now_ns < self._next_ns + SECOND_NS
            self._before_ns = self._lost_ns if adjoining or self._lost_ns > self._most_ns else 0
            self._lost_ns = 0
            self._next_ns = now_ns + SECOND_NS
        return self._lost_ns > self._most_ns or self._before_ns > self._most_ns
