"""Rows as UDP datagrams of JSON with a `timestamp`, as PlotJuggler and others take them."""

import asyncio
import json
import math
import socket
import time
from typing import Any

from hilplant.arrays import Floats
from hilplant.channel.run_files import columns
from hilplant.failure import Failure
from hilplant.runtime.follower import Follower
from hilplant.units import SECOND_NS

#: Every tenth tick is sent: a hundred a second at a step of 1 ms.
EVERY_TICKS = 10
_LOOK_S = 0.01


def target(text: str) -> tuple[str, int]:
    """Read ``udp:HOST:PORT``.

    Raises
    ------
    Failure
        When it is something else.
    """
    kind, _, address = text.partition(":")
    host, _, port = address.rpartition(":")
    if kind != "udp" or not host or not (port.isascii() and port.isdigit() and 0 < int(port) < 65536):
        raise Failure(f"--stream '{text}': write udp:HOST:PORT, such as udp:127.0.0.1:9870")
    return host.strip("[]"), int(port)


class Datagrams:
    """Sends what a run does to one address."""

    def __init__(self, ring: str, to: str) -> None:
        """Open the socket.

        Raises
        ------
        Failure
            When the address cannot be used.
        """
        host, port = target(to)
        try:
            family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
        except OSError as error:
            raise Failure(f"--stream {to}: {error.strerror or error}") from error
        self._address: tuple[Any, ...] = address
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._follower = Follower(ring)
        self._names = [name for name, _ in columns()]
        self.sent = self.failed = 0

    async def work(self) -> None:
        """Send for as long as the run goes on; what nobody takes is lost and counted."""
        while True:
            rows: Floats = self._follower.rows().records
            offset_s = time.time() - rows[-1, 1] / SECOND_NS if len(rows) else 0.0
            for row in rows[rows[:, 0] % EVERY_TICKS == 0]:
                try:
                    self._socket.sendto(self.datagram(row, offset_s), self._address)
                    self.sent += 1
                except OSError:
                    self.failed += 1
            await asyncio.sleep(_LOOK_S)

    def datagram(self, row: Floats, offset_s: float) -> bytes:
        """Return one row; the time stamp is the wall's, values that are not finite are left out."""
        values = {
            name: value
            for name, value in zip(self._names[2:], row[2:].tolist(), strict=True)
            if math.isfinite(value) and not name.startswith("state.")
        }
        return json.dumps({"timestamp": offset_s + row[1] / SECOND_NS, "tick": int(row[0]), **values}).encode()
