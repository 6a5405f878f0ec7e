"""A page's files, its routes under /api and its socket -> one ASGI application that lets only its own users in."""

import asyncio
import contextlib
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from starlette.applications import Starlette
from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.routing import BaseRoute, Mount, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Lifespan, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from hilplant.web.access import HEADERS, Access, is_local_name, is_own_origin
from hilplant.web.visitor import Visitor, greeted

_STATIC = Path(__file__).parent / "static"
_API = "/api/"


@dataclass(frozen=True, slots=True)
class Page:
    """What a page consists of: a folder with its `index.html`, routes under `/api/`, public routes, one socket.

    `serve` is called for each browser that has shown the token on the socket, and returns when it is done with it.
    """

    folder: Path
    routes: Sequence[BaseRoute] = ()
    public: Sequence[BaseRoute] = ()
    serve: Callable[[Visitor], Awaitable[None]] | None = None
    lifespan: Lifespan[Starlette] | None = None


def application(page: Page, access: Access) -> ASGIApp:
    """Return the application of a page."""

    async def socket(websocket: WebSocket) -> None:
        if page.serve is not None:
            await greeted(websocket, access, page.serve)

    routes: list[BaseRoute] = [
        Mount(_API, routes=list(page.routes)),
        *page.public,
        *([WebSocketRoute("/socket", socket)] if page.serve is not None else []),
        Mount("/shared", StaticFiles(directory=_STATIC / "shared")),
        Mount("/vendor", StaticFiles(directory=_STATIC / "vendor")),
        Mount("/", StaticFiles(directory=page.folder, html=True)),
    ]
    return Guarded(Starlette(routes=routes, lifespan=page.lifespan), access)


class Guarded:
    """Checks host, origin, token and size before the application sees a request."""

    def __init__(self, inner: ASGIApp, access: Access) -> None:
        """Stand before `inner`."""
        self._inner, self._access = inner, access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or answer it with what is wrong with it."""
        if scope["type"] == "lifespan":
            await self._inner(scope, receive, send)
            return
        headers = Headers(scope=scope)
        status, reason = self._verdict(scope, headers)
        if status == 0:
            limited = _limited(receive, self._access.limits.body_bytes) if scope["type"] == "http" else receive
            try:
                await self._inner(scope, limited, _with_headers(send))
            except asyncio.CancelledError:  # the server ends, and waits for no answer
                with contextlib.suppress(RuntimeError):  # a part of the answer was sent
                    await PlainTextResponse("the server has ended\n", 503)(scope, receive, send)
            return
        self._access.refuse(reason)
        if scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008, "reason": reason})
            return
        await PlainTextResponse(reason + "\n", status)(scope, receive, _with_headers(send))

    def _verdict(self, scope: Scope, headers: Headers) -> tuple[int, str]:
        host = headers.get("host", "")
        if not is_local_name(host):
            return 421, "wrong host"
        if not is_own_origin(headers.get("origin"), host):
            return 403, "foreign origin"
        if scope["type"] == "websocket":
            return (403, "too many pages") if self._access.sockets >= self._access.limits.sockets else (0, "")
        if scope["path"].startswith(_API) and not self._access.knows(_bearer(headers)):
            return 401, "wrong token"
        if not _is_size(headers.get("content-length", "0"), self._access.limits.body_bytes):
            return 413, "too large"
        return 0, ""


def _bearer(headers: Headers) -> str:
    scheme, _, token = headers.get("authorization", "").partition(" ")
    return token if scheme == "Bearer" else ""


def _is_size(text: str, most: int) -> bool:
    return text.isascii() and text.isdigit() and int(text) <= most


def _limited(receive: Receive, most: int) -> Receive:
    """Break off a body that is longer than it said, or did not say how long it is."""
    left = most

    async def inner() -> Message:
        nonlocal left
        message = await receive()
        left -= len(message.get("body", b""))
        return message if left >= 0 else {"type": "http.disconnect"}

    return inner


def _with_headers(send: Send) -> Send:
    async def inner(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(raw=list(message.get("headers", ())))
            for name, value in HEADERS.items():
                headers[name] = value
            message["headers"] = headers.raw
        await send(message)

    return inner
