"""A python-can bus beside the plant in virtual time: waiting for a frame lets plant seconds pass, not wall seconds."""

import math
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import can
from can.broadcastmanager import CyclicSendTaskABC, ModifiableCyclicTaskABC

from hilplant.bus.frame import Frame
from hilplant.bus.transport import frame_of, message_of
from hilplant.units import SECOND_NS
from hilplant.verdicts.written import DEFAULT_WAIT_S


class End(Protocol):
    """One end of a bus: in memory, or at a channel."""

    @property
    def coming(self) -> deque[Frame]:
        """What has come and was not taken."""

    def send(self, frame: Frame) -> object:
        """Give a frame to all others."""


class VirtualCanBus(can.BusABC):
    """See `can.BusABC`; a `recv` without a timeout gives up after 10 plant seconds.

    Time passes only in calls of the test, so a `can.Notifier`, which is a thread, does not fit; `send_periodic` does.
    """

    def __init__(self, end: End, step: Callable[[], None], now_ns: Callable[[], int]) -> None:
        super().__init__(channel="hilplant")
        self.channel_info = "hilplant in virtual time"
        self._end, self._step, self._now_ns = end, step, now_ns
        self._tasks: list[VirtualTask] = []

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """Return the next frame, letting plant seconds pass until one comes or the time is up."""
        limit_ns = self._now_ns() + round((DEFAULT_WAIT_S if timeout is None else timeout) * SECOND_NS)
        while True:
            message = self._next()
            if message is not None:
                return message
            if self._now_ns() >= limit_ns:
                break
            self._step()
        if timeout is None:
            raise can.CanTimeoutError(f"no frame came within {DEFAULT_WAIT_S:g} s of virtual time")
        return None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send a frame at once."""
        self._end.send(frame_of(msg))

    def send_due(self, now_ns: int) -> None:
        """Send what periodic tasks have due."""
        for task in self._tasks:
            for message in task.due(now_ns):
                self.send(message)

    def _next(self) -> can.Message | None:
        while self._end.coming:
            message = message_of(self._end.coming.popleft())
            message.timestamp = self._now_ns() / SECOND_NS
            if self._matches_filters(message):
                return message
        return None

    def _send_periodic_internal(
        self,
        msgs: Sequence[can.Message] | can.Message,
        period: float,
        duration: float | None = None,
        autostart: bool = True,
        modifier_callback: Callable[[can.Message], None] | None = None,
    ) -> CyclicSendTaskABC:
        task = VirtualTask(msgs, period, duration, self._now_ns, modifier_callback)
        self._tasks.append(task)
        if autostart:
            task.start()
        return task

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        return self.recv(timeout), True


class VirtualTask(ModifiableCyclicTaskABC):
    """A periodic message in virtual time."""

    def __init__(
        self,
        messages: Sequence[can.Message] | can.Message,
        period: float,
        duration: float | None,
        now_ns: Callable[[], int],
        modifier: Callable[[can.Message], None] | None,
    ) -> None:
        super().__init__(messages, period)
        self._now_ns, self._modifier = now_ns, modifier
        self._duration_ns = math.inf if duration is None else duration * SECOND_NS
        self._due_ns, self._end_ns, self._place = math.inf, math.inf, 0

    def start(self) -> None:
        """Begin now."""
        self._due_ns = self._now_ns()
        self._end_ns = self._due_ns + self._duration_ns

    def stop(self) -> None:
        """Send no more."""
        self._due_ns = math.inf

    def due(self, now_ns: int) -> list[can.Message]:
        """Return what is to be sent by now."""
        found: list[Any] = []
        while now_ns >= self._due_ns and self._due_ns < self._end_ns:
            message = self.messages[self._place]
            if self._modifier is not None:
                self._modifier(message)
            found.append(message)
            self._place = (self._place + 1) % len(self.messages)
            self._due_ns += self.period * SECOND_NS
        return found
