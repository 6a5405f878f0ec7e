"""Work of a request in a thread that the end of the server does not wait for."""

import asyncio
import contextlib
import threading
from collections.abc import Callable
from typing import Any


async def in_thread(how: Callable[[Any], Any], asked: Any) -> Any:
    """Return `how(asked)`, computed in a thread that ends with the process; what it raises is raised here."""
    loop = asyncio.get_running_loop()
    done: asyncio.Future[Any] = loop.create_future()

    def settle(outcome: Any, error: BaseException | None) -> None:
        if done.cancelled():
            return
        if error is None:
            done.set_result(outcome)
        else:
            done.set_exception(error)

    def work() -> None:
        outcome, error = None, None
        try:
            outcome = how(asked)
        except BaseException as raised:
            error = raised
        with contextlib.suppress(RuntimeError):  # the loop was closed meanwhile
            loop.call_soon_threadsafe(settle, outcome, error)

    threading.Thread(target=work, daemon=True).start()
    return await done
