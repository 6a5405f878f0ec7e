"""The clocks: the one file of the runtime that knows the wall clock, and the virtual clock that replaces it."""

import math
import time
from itertools import pairwise
from typing import Protocol

try:
    import resource
except ImportError:  # not everywhere; no wait is counted there
    resource = None  # type: ignore[assignment]
else:
    _OF_THREAD = getattr(resource, "RUSAGE_THREAD", resource.RUSAGE_SELF)


class Clock(Protocol):
    """What the loop asks of time, in integer nanoseconds from an arbitrary origin."""

    def now_ns(self) -> int:
        """Return the time."""

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Return at the deadline or as soon after it as the clock can; at once if it has passed."""


def thread_cpu_ns() -> int:
    """Return the processor time that this thread has had: what others take from it does not count."""
    return time.thread_time_ns()


def thread_cpu_step_ns() -> int:
    """Return the smallest step of that time: 10 ms where the kernel counts in ticks, as User Mode Linux does."""
    seen = [thread_cpu_ns()]
    while len(seen) < 4:
        now = thread_cpu_ns()
        if now > seen[-1]:
            seen.append(now)
    return min(later - earlier for earlier, later in pairwise(seen))


def thread_waits() -> int:
    """Return how often this thread has given up its processor by itself, as to sleep; losing it does not count."""
    return resource.getrusage(_OF_THREAD).ru_nvcsw if resource is not None else 0


class WallClock:
    """The machine's monotonic clock."""

    def now_ns(self) -> int:
        """Return the monotonic time."""
        return time.monotonic_ns()

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Sleep; a signal's handler runs within the sleep, which then goes on."""
        remaining_ns = deadline_ns - time.monotonic_ns()
        if remaining_ns > 0:
            time.sleep(remaining_ns * 1e-9)

    def monotonic_ns(self, time_ns: int) -> int:
        """Return when the machine's monotonic clock shows that this one shows `time_ns`."""
        return time_ns


class PacedClock(WallClock):
    """The machine's monotonic clock slowed down: of each of its seconds, `pace` seconds pass here."""

    def __init__(self, pace: float) -> None:
        self._pace = pace
        self._origin_ns = time.monotonic_ns()

    def now_ns(self) -> int:
        """Return the slowed time."""
        return self._origin_ns + int((time.monotonic_ns() - self._origin_ns) * self._pace)

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Sleep until the slowed time is there."""
        super().sleep_until_ns(self.monotonic_ns(deadline_ns))

    def monotonic_ns(self, time_ns: int) -> int:
        """Return when the machine's clock shows that this one shows `time_ns`."""
        return self._origin_ns + math.ceil((time_ns - self._origin_ns) / self._pace)


def clock_at(pace: float) -> WallClock:
    """Return the machine's clock at a pace: a plant's second takes 1 / `pace` of the machine's."""
    return WallClock() if pace == 1.0 else PacedClock(pace)


class VirtualClock:
    """A clock that jumps from deadline to deadline: as fast as possible, and never late unless told to be."""

    def __init__(self) -> None:
        self.time_ns = 0

    def now_ns(self) -> int:
        """Return the virtual time."""
        return self.time_ns

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Jump to the deadline."""
        self.time_ns = max(self.time_ns, deadline_ns)
