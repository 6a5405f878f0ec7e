"""The stalk in the operator's hand: its moves go to the bus as the ECU's message, or as lines to a demonstration."""

import asyncio
import os

from hilplant.bench import Bench
from hilplant.bus.transport import open_transport
from hilplant.ecu.stalk import PRESSES_S, Move, move_named, moved, wanted
from hilplant.ecu.stalk_sender import StalkSender
from hilplant.ecu.vocabulary import Stalk
from hilplant.failure import Failure
from hilplant.units import SECOND_NS

_EVERY_S = 0.01  # looks for what is due


class StalkOfLines:
    """Writes each move as a line, for :class:`hilplant.ecu.stalk.TypedStalk`."""

    def __init__(self, descriptor: int) -> None:
        """Write to an open file."""
        self._descriptor = descriptor

    def move(self, text: str) -> None:
        """Move the stalk."""
        _known(text)
        os.write(self._descriptor, f"{text}\n".encode())

    async def work(self) -> None:
        """There is nothing to repeat."""


class StalkOnBus:
    """Sends the bench's messages of the stalk from the first move on."""

    def __init__(self, bench: Bench) -> None:
        """Take the messages.

        Raises
        ------
        Failure
            When the bench has none.
        """
        if not bench.ecu_messages.driver:
            raise Failure("the bench's ECU hears no stalk message")
        self._bench = bench
        self._sender: StalkSender | None = None
        self._stalk, self._pressed_until_s = Stalk(), dict.fromkeys(PRESSES_S, 0.0)

    def move(self, text: str) -> None:
        """Move the stalk.

        Raises
        ------
        Failure
            When there is no such position, or the interface cannot be opened.
        """
        move = _known(text)
        if self._sender is None:
            self._sender = StalkSender(self._bench.ecu_messages.driver, open_transport(self._bench.interface))
        if move.press is not None:
            self._pressed_until_s[move.press] = _now_s() + PRESSES_S[move.press]
        self._stalk = moved(self._stalk, move._replace(press=None))
        self._send(self._sender)

    async def work(self) -> None:
        """Send for as long as the page is served."""
        try:
            while True:
                await asyncio.sleep(_EVERY_S)
                if self._sender is not None:
                    self._send(self._sender)
        finally:
            if self._sender is not None:
                self._sender.close()

    def _send(self, sender: StalkSender) -> None:
        now_s = _now_s()
        flick, wash = (now_s < self._pressed_until_s[button] for button in ("flick", "wash"))
        sender.act(round(now_s * SECOND_NS), self._stalk._replace(flick=flick, wash=wash))


def _known(text: str) -> Move:
    move = move_named(text)
    if move is None:
        raise Failure(f"the stalk's position must be {wanted()}")
    return move


def _now_s() -> float:
    return asyncio.get_running_loop().time()
