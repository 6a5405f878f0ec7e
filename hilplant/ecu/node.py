"""The stand-in ECU on the bus: hears stalk, park switch, current and supply; commands relays; tells its state."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from hilplant.bench.ecu_side import EcuSide
from hilplant.bus.codec import ReceivedMessage, SentMessage
from hilplant.bus.link import LinkSettings
from hilplant.bus.node import Node
from hilplant.bus.transport import Transport
from hilplant.ecu.relay_controller import ControllerState, advance
from hilplant.ecu.stalk import StalkSource
from hilplant.ecu.vocabulary import RELAYS_OFF, EcuInputs, Fault, Master, RelayCommand, RelaySettings, Stalk
from hilplant.runtime.clock import Clock
from hilplant.signals import ECU_FAULTS, ECU_RX, ECU_RX_INDEX, ECU_STATES, ECU_TX, ECU_TX_INDEX
from hilplant.units import MILLISECOND_NS, SECOND_NS

_PARK, _CURRENT, _SUPPLY, _RAIN = (
    ECU_RX_INDEX[name] for name in ("park_contact", "current_a", "supply_v", "rain_sensor")
)
_MASTER, _INTERVAL, _FLICK, _WASH, _AUTOMATIC = (
    ECU_RX_INDEX[name] for name in ("master_input", "intermittent_switch", "flick_wipe", "wash", "automatic")
)
_COMMANDS = tuple(ECU_TX_INDEX[name] for name in ("relay_on", "relay_fast", "washer_pump"))
_TOLD = tuple(ECU_TX_INDEX[name] for name in ("ecu_state", "ecu_fault", "ecu_tries"))


class EcuReport(NamedTuple):
    """What the ECU did at one moment, for those who watch."""

    time_s: float
    stalk: Stalk
    state: ControllerState
    relays: RelayCommand
    fault: Fault
    park_known: bool


class EcuNode:
    """A CAN node with the relay controller in it.

    Of the bench's messages it takes those with the park contact, the motor current, the supply voltage or the rain
    sensor, and sends those that carry a relay or the washer pump, which runs while the driver washes; supply and
    environment stay with those who command them. The stalk and the ECU's status are messages of its own. While the park
    contact is unknown the relays are off. `report` is called at each poll; `counts` are the node's, by
    ``signals.STATUS``.
    """

    def __init__(self, side: EcuSide, transport: Transport, settings: RelaySettings) -> None:
        """Join the bus with the ECU's side of a bench's messages."""
        self.state = ControllerState()
        self.report: Callable[[EcuReport], None] | None = None
        self._settings = settings
        self._said = [signal.default for signal in ECU_TX]
        heard = [*_that_carry((_PARK, _CURRENT, _SUPPLY, _RAIN), side.receive), *side.stalk]
        sent = [*_commands(side.send), *side.status]
        self._node = Node(heard, sent, transport, LinkSettings(), [math.nan] * len(ECU_RX))
        self._node.rehearse(self._said)  # so that its first poll does not hold up a loop on the same processor

    @property
    def counts(self) -> list[int]:
        """What went wrong on the bus, by ``signals.STATUS``."""
        return self._node.counts

    def poll(self, now_ns: int, stalk: Stalk) -> RelayCommand:
        """Take in frames, decide, send what is due; `now_ns` must not run backwards.

        `stalk` is that of the hand at this end; a stalk that is heard on the bus goes before it.
        """
        self._node.receive(now_ns)
        heard_once = not math.isnan(self._node.values[_MASTER])
        lost = heard_once and self._node.silent(_MASTER)
        stalk = self._heard_stalk() if heard_once and not lost else stalk
        contact = self._known(_PARK)
        closed = None if math.isnan(contact) else contact > 0.5
        inputs = EcuInputs(stalk, closed, self._known(_CURRENT), self._known(_SUPPLY), self._known(_RAIN))
        now_s = now_ns / SECOND_NS
        self.state, relays, fault = advance(self.state, inputs, now_s, self._settings)
        fault = Fault.STALK_LOST if lost and fault is Fault.NONE else fault
        self._say(relays, fault, stalk.wash)
        self._node.send(now_ns, self._said)
        if self.report is not None:
            self.report(EcuReport(now_s, stalk, self.state, relays, fault, closed is not None))
        return relays

    def release(self) -> None:
        """Send the relays off, once: the last word before the ECU leaves the bus."""
        self._say(RELAYS_OFF, self.state.fault)
        self._node.send_all(self._said)

    def close(self) -> None:
        """Give the interface back."""
        self._node.close()

    def _known(self, target: int) -> float:
        """Return a value as last heard, nan when that is too long ago."""
        return math.nan if self._node.silent(target) else self._node.values[target]

    def _heard_stalk(self) -> Stalk:
        values = self._node.values
        interval = 1 if math.isnan(values[_INTERVAL]) else round(values[_INTERVAL])
        flick, wash, automatic = (values[index] > 0.5 for index in (_FLICK, _WASH, _AUTOMATIC))
        return Stalk(Master(round(values[_MASTER])), interval, flick, wash, automatic)

    def _say(self, relays: RelayCommand, fault: Fault, washes: bool = False) -> None:
        told = (_STATE_NUMBERS[self.state.phase.value], _FAULT_NUMBERS[fault.value], float(self.state.tries))
        for index, value in zip((*_COMMANDS, *_TOLD), (*relays, washes, *told), strict=True):
            self._said[index] = float(value)


_STATE_NUMBERS = {name: float(number) for number, name in enumerate(ECU_STATES)}
_FAULT_NUMBERS = {name: float(number) for number, name in enumerate(ECU_FAULTS)}


def _that_carry(targets: Sequence[int], messages: Sequence[ReceivedMessage]) -> list[ReceivedMessage]:
    return [message for message in messages if set(targets) & set(message.targets)]


def _commands(messages: Sequence[SentMessage]) -> list[SentMessage]:
    return [message for message in messages if set(_COMMANDS) & set(message.sources)]


def run_ecu(
    node: EcuNode,
    stalk: StalkSource,
    clock: Clock,
    stop: Callable[[], bool],
    pause_ns: int = 5 * MILLISECOND_NS,
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
