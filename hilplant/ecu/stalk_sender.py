"""The driver's end of the bus: says where the stalk stands, as the ECU hears it."""

from collections.abc import Sequence

from hilplant.bus.codec import SentMessage
from hilplant.bus.link import LinkSettings
from hilplant.bus.node import Node
from hilplant.bus.transport import Transport
from hilplant.ecu.vocabulary import Stalk
from hilplant.signals import ECU_RX, STALK


class StalkSender:
    """Sends the bench's messages of the stalk (`EcuMessages.driver`): each at its cycle time, and when it changes."""

    def __init__(self, messages: Sequence[SentMessage], transport: Transport) -> None:
        """Join the bus."""
        self._node = Node([], messages, transport, LinkSettings(), [])

    def act(self, now_ns: int, stalk: Stalk) -> None:
        """Send what is due; `now_ns` must not run backwards."""
        self._node.receive(now_ns)  # what others say is not for the hand
        told = [float(value) for _, value in zip(STALK, stalk, strict=True)]
        self._node.send(now_ns, [0.0] * (len(ECU_RX) - len(STALK)) + told)

    def close(self) -> None:
        """Give the interface back."""
        self._node.close()
