"""Serve a page: in this process until it is told to end, or as a process beside a run."""

import asyncio
import socket
import webbrowser
from collections.abc import Callable
from dataclasses import dataclass
from types import FrameType
from typing import Any

import uvicorn
from starlette.types import ASGIApp

from hilplant.failure import Failure
from hilplant.web.access import Access

#: Only programs on this machine reach a page, unless another address is asked for; 0 is any free port.
LOOPBACK, PORT = "127.0.0.1", 8765


@dataclass(frozen=True, slots=True)
class Address:
    """Where a page is served; a port of its own choice may be another one when it is taken."""

    host: str = LOOPBACK
    port: int = PORT
    chosen: bool = False

    @classmethod
    def parse(cls, text: str) -> "Address":
        """Read ``HOST:PORT``, ``PORT``, or nothing for the default.

        Raises
        ------
        Failure
            When it is neither.
        """
        if not text:
            return cls()
        host, _, port = text.rpartition(":")
        if not (port.isascii() and port.isdigit() and int(port) < 65536):
            raise Failure(f"'{text}' is no address for a page: write HOST:PORT, such as {LOOPBACK}:{PORT}")
        return cls(host.strip("[]") or LOOPBACK, int(port), True)

    def listen(self) -> socket.socket:
        """Return a socket that listens here.

        Raises
        ------
        Failure
            When that cannot be.
        """
        family = socket.AF_INET6 if ":" in self.host else socket.AF_INET
        for port in (self.port,) if self.chosen else (self.port, 0):
            # With its protocol named, asyncio sends without Nagle's delay (40 ms beside a delayed acknowledgement).
            listening = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                listening.bind((self.host, port))
                listening.listen(64)
                return listening
            except OSError as error:
                listening.close()
                reason = error.strerror or str(error)
        raise Failure(f"no page at {self.host}:{self.port}: {reason}")


def url_of(listening: socket.socket, access: Access) -> str:
    """Return the address to open, with the token in its fragment, which no browser sends anywhere."""
    host, port = listening.getsockname()[:2]
    if host in ("0.0.0.0", "::"):
        host = socket.gethostname()
    return f"http://{f'[{host}]' if ':' in host else host}:{port}/#token={access.token}"


class _Server(uvicorn.Server):
    """Ends on a signal, or several, without raising it again, so that who serves comes to the end of what he does."""

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        self.should_exit = True


async def serve(
    app: ASGIApp, access: Access, address: Address, ready: Callable[[str], None], ended: asyncio.Event | None = None
) -> None:
    """Serve until SIGINT, SIGTERM or `ended`; `ready` is told the address to open.

    Raises
    ------
    Failure
        When nothing can listen at the address.
    """
    listening = address.listen()
    settings: dict[str, Any] = {
        "ws": "websockets-sansio",
        "ws_max_size": access.limits.message_bytes,
        "ws_per_message_deflate": False,
        "ws_ping_interval": 5.0,
        "ws_ping_timeout": 10.0,
        "limit_concurrency": 128,
        "timeout_graceful_shutdown": 1,
        "h11_max_incomplete_event_size": 16384,
        "server_header": False,
        "log_config": None,
        "access_log": False,
    }
    server = _Server(uvicorn.Config(app, **settings))

    async def end() -> None:
        if ended is not None:
            await ended.wait()
            server.should_exit = True

    ending = asyncio.create_task(end())
    try:
        with server.capture_signals():  # before anybody knows of it
            ready(url_of(listening, access))
            await server.serve(sockets=[listening])
    finally:
        ending.cancel()
        listening.close()


def open_browser(url: str) -> bool:
    """Open a page in the user's browser, if there is one."""
    return webbrowser.open(url)
