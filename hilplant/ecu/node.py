"""The stand-in ECU on the bus: reads the park switch, lets the controller decide, commands the relays."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from hilplant.bus.codec import ReceivedMessage, SentMessage
from hilplant.bus.node import LinkSettings, Node
from hilplant.bus.transport import Transport
from hilplant.ecu.relay_controller import RELAYS_OFF, Relays, Settings, Stalk, State, advance
from hilplant.ecu.stalk import StalkSource
from hilplant.runtime.clock import Clock
from hilplant.signals import INPUT_INDEX, INPUTS, PUBLISHED, PUBLISHED_INDEX
from hilplant.units import MILLISECOND_NS, SECOND_NS

_PARK = PUBLISHED_INDEX["park_contact"]
_RELAYS = (INPUT_INDEX["relay_on"], INPUT_INDEX["relay_fast"])


class Report(NamedTuple):
    """What the ECU did at one moment, for whoever watches."""

    time_s: float
    stalk: Stalk
    state: State
    relays: Relays
    park_known: bool


class EcuNode:
    """A CAN node with the relay controller in it.

    Of the bench's messages it takes the one that carries the park contact and sends those that carry a relay;
    supply and environment stay with whoever commands them. While the park contact is unknown the relays are
    off. `report` is called at each poll.
    """

    def __init__(
        self,
        received: Sequence[ReceivedMessage],
        sent: Sequence[SentMessage],
        transport: Transport,
        settings: Settings,
    ) -> None:
        """Join the bus with the ECU's side of a bench's messages."""
        park = [message for message in received if _PARK in message.targets]
        relays = [message for message in sent if set(_RELAYS) & set(message.sources)]
        self.state = State()
        self.report: Callable[[Report], None] | None = None
        self._settings = settings
        self._commands = [signal.default for signal in INPUTS]
        self._node = Node(park, relays, transport, LinkSettings(), [math.nan] * len(PUBLISHED))

    def poll(self, now_ns: int, stalk: Stalk) -> Relays:
        """Take in frames, decide, send what is due; `now_ns` must not run backwards."""
        self._node.receive(now_ns)
        value = self._node.values[_PARK]
        contact = None if self._node.lost or math.isnan(value) else value > 0.5
        now_s = now_ns / SECOND_NS
        self.state, relays = advance(self.state, stalk, contact, now_s, self._settings)
        self._command(relays)
        self._node.send(now_ns, self._commands)
        if self.report is not None:
            self.report(Report(now_s, stalk, self.state, relays, contact is not None))
        return relays

    def release(self) -> None:
        """Send the relays off, once: the last word before the ECU leaves the bus."""
        self._command(RELAYS_OFF)
        self._node.send_all(self._commands)

    def close(self) -> None:
        """Give the interface back."""
        self._node.close()

    def _command(self, relays: Relays) -> None:
        for index, value in zip(_RELAYS, relays, strict=True):
            self._commands[index] = float(value)


def run_ecu(
    node: EcuNode,
    stalk: StalkSource,
    clock: Clock,
    stop: Callable[[], bool],
    pause_ns: int = 2 * MILLISECOND_NS,
) -> None:
    """Poll until `stop` says so, resting `pause_ns` in between, then release the relays."""
    start_ns = clock.now_ns()
    try:
        while not stop():
            now_ns = clock.now_ns()
            elapsed_ns = now_ns - start_ns
            node.poll(elapsed_ns, stalk(elapsed_ns / SECOND_NS))
            clock.sleep_until_ns(now_ns + pause_ns)
    finally:
        node.release()
