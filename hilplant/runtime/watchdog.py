"""The service manager's view of the daemon: ready, alive, ending (the sd_notify datagrams of systemd)."""

import contextlib
import os
import socket

from hilplant.units import MICROSECOND_NS


class Watchdog:
    """Sends state to the socket that systemd names in the environment; silent where there is none."""

    def __init__(self, pace: float = 1.0) -> None:
        """Find the socket; the loop counts its time at this pace."""
        self._pace = pace
        address = os.environ.get("NOTIFY_SOCKET", "")
        self._address = "\0" + address[1:] if address.startswith("@") else address
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) if self._address else None
        if self._socket is not None:
            self._socket.setblocking(False)

    @property
    def period_ns(self) -> int:
        """How often to feed, in the loop's time: a third of what systemd waits for, 0 when it does not watch."""
        return int(int(os.environ.get("WATCHDOG_USEC", "0")) * MICROSECOND_NS * self._pace) // 3

    def ready(self) -> None:
        """Say that the loop starts."""
        self._tell(b"READY=1")

    def feed(self) -> None:
        """Say that a tick was healthy."""
        self._tell(b"WATCHDOG=1")

    def stopping(self) -> None:
        """Say that the daemon ends on purpose."""
        self._tell(b"STOPPING=1")

    def _tell(self, text: bytes) -> None:
        if self._socket is not None:
            with contextlib.suppress(OSError):
                self._socket.sendto(text, self._address)
