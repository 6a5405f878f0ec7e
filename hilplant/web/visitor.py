"""One browser on the socket of a page: shows the token first, then sends JSON objects and takes text or floats."""

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from hilplant.web.access import Access, Rate

_GREETING_S, _SEND_S = 5.0, 5.0
#: Codes with which the server closes a socket; the page's `link.js` tells them to the user.
WRONG_TOKEN, TOO_SLOW, TOO_MUCH = 4401, 4408, 4429
#: Code of the protocol for a message that is larger than it may be.
TOO_LARGE = 1009
#: A client is disconnected once it has sent so much nonsense, or so much too quickly.
_MOST_NONSENSE = 20_000


class Visitor:
    """The socket of one browser that may be here."""

    def __init__(self, websocket: WebSocket, access: Access) -> None:
        """Take an accepted socket."""
        self._websocket, self._access = websocket, access
        self._rate = Rate(access.limits.messages_per_s, access.limits.burst)
        self._nonsense = 0

    async def messages(self) -> AsyncIterator[dict[str, Any]]:
        """Yield what the browser sends until it goes; what is malformed or too quick is counted and left out."""
        while True:
            try:
                message = await self._websocket.receive()
            except (WebSocketDisconnect, RuntimeError):
                return
            if message["type"] == "websocket.disconnect":
                if message.get("code") == TOO_LARGE:
                    self._access.refuse("too large")
                return
            if not self._rate.allows(asyncio.get_running_loop().time()):
                await self._drop("too quick")
            elif (found := parsed(message.get("text"))) is None:
                await self._drop("malformed")
            else:
                yield found
            if self._nonsense > _MOST_NONSENSE:
                await self.close(TOO_MUCH)
                return

    async def _drop(self, reason: str) -> None:
        self._nonsense += 1
        self._access.refuse(reason)

    async def tell(self, message: dict[str, Any]) -> None:
        """Send an object as text."""
        await self._within_time(self._websocket.send_text(json.dumps(message)))

    async def give(self, data: bytes) -> None:
        """Send floats."""
        await self._within_time(self._websocket.send_bytes(data))

    async def _within_time(self, sending: Awaitable[None]) -> None:
        """Send, or give up a browser that takes nothing any more.

        Raises
        ------
        ConnectionError
            When it is gone.
        """
        try:
            await asyncio.wait_for(sending, _SEND_S)
        except TimeoutError as error:
            await self.close(TOO_SLOW)
            raise ConnectionError from error
        except (WebSocketDisconnect, RuntimeError) as error:  # it went meanwhile
            raise ConnectionError from error

    async def gone(self) -> None:
        """Count why the browser went, where sending has failed before that was read."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(1.0):
                async for _ in self.messages():
                    pass

    async def close(self, code: int) -> None:
        """End the connection."""
        with contextlib.suppress(WebSocketDisconnect, RuntimeError, OSError):
            await self._websocket.close(code)


def parsed(text: object) -> dict[str, Any] | None:
    """Return the JSON object in a text, None where there is none."""
    if not isinstance(text, str):
        return None
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return None
    return found if isinstance(found, dict) else None


async def greeted(websocket: WebSocket, access: Access, serve: Callable[[Visitor], Awaitable[None]]) -> None:
    """Serve a browser once its first message has shown the token."""
    access.sockets += 1
    try:
        await websocket.accept()
        try:
            first = parsed(await asyncio.wait_for(websocket.receive_text(), _GREETING_S))
        except WebSocketDisconnect as gone:
            access.refuse("too large" if gone.code == TOO_LARGE else "no token")
            return
        except (TimeoutError, KeyError, RuntimeError):
            first = None
        visitor = Visitor(websocket, access)
        if first is None or not access.knows(first.get("token")):
            access.refuse("wrong token")
            await visitor.close(WRONG_TOKEN)
            return
        try:
            await serve(visitor)
        except ConnectionError:
            await visitor.gone()
        await visitor.close(1000)
    finally:
        access.sockets -= 1
