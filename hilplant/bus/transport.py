"""Opens CAN interfaces; the only file of the bus that uses python-can.

SocketCAN is driven directly, because python-can spends five system calls where one serves; every other
interface that python-can knows is driven through it, polled, without its threads.
"""

import contextlib
import logging
import os
import threading
from collections import deque
from typing import Any, cast

from hilplant.bus.arrival import waited_ns
from hilplant.bus.frame import Frame
from hilplant.bus.interface import SendResult, Transport, TransportError
from hilplant.bus.lean_import import without_asammdf
from hilplant.bus.socketcan import open_socketcan, wrong_settings
from hilplant.extras import missing, remedy
from hilplant.units import SECOND_NS

with without_asammdf():
    import can

__all__ = ["PythonCan", "SendResult", "Transport", "TransportError", "open_transport", "wrong_interface"]


def wrong_interface(arguments: dict[str, Any]) -> str | None:
    """Return what is wrong with a bench's interface, as far as can be told without opening it; None if nothing is."""
    interface = arguments["interface"]
    if interface == "socketcan":
        return wrong_settings(arguments)
    if interface not in can.VALID_INTERFACES:
        return f"python-can has no interface '{interface}'; there are {_known()}"
    return None


def open_transport(arguments: dict[str, Any]) -> Transport:
    """Open the interface that a bench names: `interface`, `channel` and whatever else that interface takes.

    Raises
    ------
    TransportError
        In one line, with what would be right.

    """
    interface = arguments.get("interface")
    if not interface:
        raise TransportError(f"the bus names no interface; there are {_known()}")
    if interface == "socketcan":
        return open_socketcan(arguments)
    return PythonCan(arguments)


def is_multicast(arguments: dict[str, Any]) -> bool:
    """Say whether a bus is a multicast group."""
    return bool(arguments.get("interface") == "udp_multicast")


def interface_needs_udp(arguments: dict[str, Any]) -> bool:
    """Say whether an interface needs an optional library that is not installed."""
    return is_multicast(arguments) and bool(missing("udp"))


class PythonCan:
    """An interface of python-can; see `Transport`."""

    def __init__(self, arguments: dict[str, Any]) -> None:
        self._arguments = dict(arguments)
        self._bus = _open(self._arguments)
        self._up = True
        self._reopening: _Reopening | None = None
        # what comes back to its sender, in order: a multicast socket is the one interface that does not keep it away
        self._coming_back: deque[Frame] | None = deque(maxlen=256) if is_multicast(arguments) else None
        self._in_memory = arguments["interface"] == "virtual"

    @property
    def up(self) -> bool:
        """Whether frames can pass."""
        if self._reopening is not None and self._reopening.done:
            self._bus, self._up, self._reopening = (
                self._reopening.bus or self._bus,
                self._reopening.bus is not None,
                None,
            )
        return self._up

    @property
    def missed(self) -> int:
        """Always 0: python-can has no word for it."""
        return 0

    def receive(self, limit: int) -> list[Frame]:
        """Return the frames that have arrived, at most `limit`."""
        return [frame for frame, _ in self._received(limit)]

    def receive_late(self, limit: int) -> list[tuple[Frame, int | None]]:
        """Return the frames that have arrived, with how long they have waited, by the driver's stamps."""
        return [(frame, waited_ns(round(stamp_s * SECOND_NS))) for frame, stamp_s in self._received(limit)]

    def _received(self, limit: int) -> list[tuple[Frame, float]]:
        """Return frames of others and their stamps [s]."""
        received: list[tuple[Frame, float]] = []
        try:
            while self._up and len(received) < limit:
                message = self._bus.recv(0)
                if message is None:
                    break
                frame = frame_of(message)
                if not (self._coming_back and self._is_own(frame, self._coming_back)):
                    received.append((frame, message.timestamp))
        except Exception:  # drivers raise whatever their libraries raise
            self._up = False
        return received

    @staticmethod
    def _is_own(frame: Frame, coming_back: deque[Frame]) -> bool:
        if frame not in coming_back:
            return False
        while coming_back.popleft() != frame:  # those before it were lost on the way
            pass
        return True

    def send(self, frame: Frame) -> SendResult:
        """Hand a frame over to the driver; one that it does not take now counts as a full queue."""
        if not self._up:
            return SendResult.DOWN
        message = message_of(frame)
        if self._in_memory:
            message.data = cast("bytearray", frame.data)  # bytes are copied in a tenth of the time
        try:
            self._bus.send(message, timeout=0)
        except can.CanError:
            return SendResult.FULL
        except ValueError:
            return SendResult.REFUSED
        except Exception:  # the device is gone; see receive
            self._up = False
            return SendResult.DOWN
        if self._coming_back is not None:
            self._coming_back.append(frame)
        return SendResult.SENT

    def reopen(self) -> bool:
        """Have a new bus object tried beside the loop, which a driver may keep waiting; `up` tells when it works."""
        if not self.up and self._reopening is None:
            self._reopening = _Reopening(self._bus, self._arguments)
            self._reopening.start()
            if self._coming_back:
                self._coming_back.clear()
        return self._up

    def close(self) -> None:
        """Shut the bus down; one that is only just being opened is left to the end of the process."""
        if self.up:
            _shut(self._bus)
        self._up = False


class _Reopening(threading.Thread):
    """Shuts a bus down and opens it anew, once; `bus` is the new one when `done`, None where that failed."""

    def __init__(self, old: can.BusABC, arguments: dict[str, Any]) -> None:
        super().__init__(daemon=True, name="reopen")
        self.done = False
        self.bus: can.BusABC | None = None
        self._old, self._arguments = old, arguments

    def run(self) -> None:
        """Do it, at an ordinary priority: a thread inherits that of the loop."""
        with contextlib.suppress(OSError, AttributeError):  # only Linux has it
            os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        _shut(self._old)
        with contextlib.suppress(TransportError):
            self.bus = _open(self._arguments)
        self.done = True


def _shut(bus: can.BusABC) -> None:
    with contextlib.suppress(Exception):  # drivers raise whatever their libraries raise
        bus.shutdown()


def _open(arguments: dict[str, Any]) -> can.BusABC:
    """Open a bus by the bench's arguments alone; python-can's own configuration files are left aside."""
    if wrong := wrong_interface(arguments):
        raise TransportError(wrong)
    said = _Said()
    logger = logging.getLogger("can")
    logger.addHandler(said)
    try:
        return can.Bus(**arguments, ignore_config=True)
    except Exception as error:  # drivers raise whatever their libraries raise
        reason = " ".join(str(error).split()) or type(error).__name__
        given = ", ".join(f"{name}: {value}" for name, value in arguments.items() if name != "interface")
        advice = [f"it needs msgpack: {remedy('udp')}"] if interface_needs_udp(arguments) else []
        reasons = "; ".join([reason, *said.lines, *advice])
        raise TransportError(
            f"the interface {arguments['interface']} ({given or 'no arguments'}) cannot be opened: {reasons}"
        ) from error
    finally:
        logger.removeHandler(said)


class _Said(logging.Handler):
    """What python-can logs while it opens an interface, often the real reason; else it would stand on stderr."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.lines: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        if record.name != "can.bus":  # which tells of buses that were never shut down, of any age
            self.lines.append(" ".join(record.getMessage().split()))


def _known() -> str:
    return ", ".join(sorted(can.VALID_INTERFACES))


def frame_of(message: can.Message) -> Frame:
    """Return a frame of python-can as ours."""
    return Frame(
        message.arbitration_id,
        bytes(message.data),
        message.is_extended_id,
        message.is_fd,
        message.bitrate_switch,
        message.is_remote_frame,
        message.is_error_frame,
    )


def message_of(frame: Frame) -> can.Message:
    """Return a frame as one of python-can."""
    return can.Message(
        arbitration_id=frame.identifier,
        is_extended_id=frame.extended,
        is_remote_frame=frame.remote,
        is_fd=frame.fd,
        bitrate_switch=frame.bitrate_switch,
        data=frame.data,
    )
