"""The stalk in the operator's hand: its moves go to the bus as the ECU's message, or as lines to a demonstration."""

import asyncio
import contextlib
import os
from typing import Any

from hilplant.bench import Bench
from hilplant.bus.database import database_among
from hilplant.bus.transport import Transport, open_transport
from hilplant.ecu.stalk import PRESSES_S, Move, move_named, moved, wanted
from hilplant.ecu.vocabulary import Stalk
from hilplant.failure import Failure
from hilplant.testing.sending import CyclicMessage

_EVERY_S = 0.1  # of messages without a cycle time


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
    """Sends the bench's stalk message from the first move on: at its cycle time, and at once when the hand moves."""

    def __init__(self, bench: Bench) -> None:
        """Find the message.

        Raises
        ------
        Failure
            When the bench has none.
        """
        mapped = bench.description.ecu.receive or {}
        if not mapped:
            raise Failure("the bench's ECU hears no stalk message")
        database = database_among(bench.sources)
        messages = {each.name: each for each in database.messages} if database is not None else {}
        self._messages = [(CyclicMessage(messages[name], None), entry.signals) for name, entry in mapped.items()]
        self._interface = bench.interface
        self._transport: Transport | None = None
        self._stalk, self._pressed = Stalk(), {word: 0.0 for word in PRESSES_S}
        self._moved = asyncio.Event()

    def move(self, text: str) -> None:
        """Move the stalk."""
        move = _known(text)
        if self._transport is None:
            self._transport = open_transport(self._interface)
        if move.press is not None:
            self._pressed[move.press] = _now_s() + PRESSES_S[move.press]
        self._stalk = moved(self._stalk, move._replace(press=None), 0.0)
        self._moved.set()

    async def work(self) -> None:
        """Send for as long as the page is served."""
        while True:
            if self._transport is not None:
                self._transport.receive(64)  # what others say is not for the stalk
                for message, signals in self._messages:
                    message.change(self._values(signals))
                    self._transport.send(message.frame())
            period_s = max((message.period_ns for message, _ in self._messages), default=0) / 1e9 or _EVERY_S
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._moved.wait(), period_s)
            self._moved.clear()

    def _values(self, signals: Any) -> dict[str, Any]:
        now_s, stalk = _now_s(), self._stalk
        told = {
            "master_input": int(stalk.master),
            "intermittent_switch": stalk.interval,
            "flick_wipe": int(now_s < self._pressed["flick"]),
            "wash": int(now_s < self._pressed["wash"]),
        }
        return {name: told[each.signal] for name, entries in signals.items() for each in entries}


def _known(text: str) -> Move:
    move = move_named(text)
    if move is None:
        raise Failure(f"the stalk's position must be {wanted()}")
    return move


def _now_s() -> float:
    return asyncio.get_running_loop().time()
