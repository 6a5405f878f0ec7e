"""A velocity controller as a CAN node: hears speed, current and park contact, commands supply and relays."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from hilplant.bench.ecu_side import EcuSide
from hilplant.bus.codec import ReceivedMessage, SentMessage
from hilplant.bus.frame import Frame
from hilplant.bus.link import LinkSettings
from hilplant.bus.node import Node
from hilplant.bus.transport import Transport
from hilplant.control.own import OwnSeat
from hilplant.control.records import Command, Measured
from hilplant.control.reference import wanted_speed
from hilplant.control.seat import Seat
from hilplant.failure import Failure
from hilplant.runtime.clock import Clock
from hilplant.signals import ECU_RX, ECU_RX_INDEX, INPUT_INDEX, INPUTS
from hilplant.units import SECOND_NS

_HEARD = tuple(ECU_RX_INDEX[name] for name in ("crank_speed_rad_s", "current_a", "measured_current_a", "park_contact"))
_SPEED, _CURRENT, _MEASURED_CURRENT, _CONTACT = _HEARD
_WANTED = ECU_RX_INDEX["reference_rad_s"]
_ON, _FAST, _SUPPLY = (INPUT_INDEX[name] for name in ("relay_on", "relay_fast", "supply_v"))


class VelocityReport(NamedTuple):
    """What the node did at one moment, for those who watch."""

    time_s: float
    reference_rad_s: float
    measured: Measured
    command: Command
    lost: bool


class VelocityNode:
    """A CAN node with a velocity controller in it, polled once in each of the controller's periods.

    A period in which no frame with the speed has come is bridged: the controller is told that nothing was measured.
    A current as its sensor shows it goes before the true one, a wanted speed that is heard before the seat's. When
    frames stay away for longer than their timeout, the relays go off and the controller begins anew.
    """

    def __init__(self, side: EcuSide, transport: Transport, seat: Seat | OwnSeat) -> None:
        """Join the bus with the ECU's side of a bench's messages."""
        heard = [message for message in side.receive if set(_HEARD) & set(message.targets)]
        commands = [message for message in side.send if {_ON, _FAST, _SUPPLY} & set(message.sources)]
        _demand(heard, commands)
        shown = any(_MEASURED_CURRENT in message.targets for message in heard)
        self._current = _MEASURED_CURRENT if shown else _CURRENT
        self.seat = seat
        self.report: Callable[[VelocityReport], None] | None = None
        self._commands = [signal.default for signal in INPUTS]
        self._speed_frames = {message.identifier for message in heard if _SPEED in message.targets}
        self._fresh = False
        heard += side.reference
        self._node = Node(heard, commands, transport, LinkSettings(), [math.nan] * len(ECU_RX))
        self._node.observe = self._observe

    def poll(self, now_ns: int) -> Command:
        """Take in frames, decide, send; `now_ns` must not run backwards."""
        self._fresh = False
        self._node.receive(now_ns)
        now_s, values = now_ns / SECOND_NS, self._node.values
        contact = values[_CONTACT]
        measured = Measured(
            values[_SPEED] if self._fresh else math.nan,
            values[self._current] if self._fresh else math.nan,
            contact if math.isfinite(contact) else 0.0,
        )
        if self._node.lost:
            self.seat.forget()
            command = Command(0.0, 0.0)
        else:
            command = self.seat.decide(now_s, measured, values[_WANTED])
        self._command(command)
        self._node.send(now_ns, self._commands)
        if self.report is not None:
            wanted = wanted_speed(self.seat.reference, now_s, values[_WANTED])
            self.report(VelocityReport(now_s, wanted, measured, command, self._node.lost))
        return command

    def release(self) -> None:
        """Send the relays off, once: the last word before the node leaves the bus."""
        self._command(Command(0.0, 0.0))
        self._node.send_all(self._commands)

    def close(self) -> None:
        """Give the interface back."""
        self._node.close()

    def _command(self, command: Command) -> None:
        self._commands[_ON] = float(command.voltage_v > 0.0)
        self._commands[_FAST] = command.fast
        self._commands[_SUPPLY] = command.voltage_v

    def _observe(self, frame: Frame, sent: bool) -> None:
        self._fresh = self._fresh or (not sent and frame.identifier in self._speed_frames)


def status_period_ns(sent: Sequence[SentMessage]) -> int:
    """Return the period of the plant's message that carries the speed, which is the controller's.

    Raises
    ------
    Failure
        When no message carries it periodically.

    """
    periods = [message.period_ns for message in sent if _SPEED in message.sources and message.period_ns]
    if not periods:
        raise Failure("no message of the bench sends crank_speed_rad_s periodically; a controller needs one")
    return min(periods)


def _demand(heard: Sequence[ReceivedMessage], commands: Sequence[SentMessage]) -> None:
    targets = {target for message in heard for target in message.targets}
    sources = {source for message in commands for source in message.sources}
    missing = [] if _SPEED in targets else [ECU_RX[_SPEED].name]
    missing += [] if {_CURRENT, _MEASURED_CURRENT} & targets else [ECU_RX[_CURRENT].name]
    missing += [INPUTS[index].name for index in (_ON, _SUPPLY) if index not in sources]
    if missing:
        raise Failure(f"the bench's messages do not carry {', '.join(missing)}; a controller needs them")


def run_velocity_node(node: VelocityNode, clock: Clock, stop: Callable[[], bool], period_ns: int) -> None:
    """Poll at absolute deadlines until `stop` says so, then release the relays."""
    start_ns = clock.now_ns()
    deadline_ns = start_ns
    try:
        while not stop():
            node.poll(clock.now_ns() - start_ns)
            deadline_ns += period_ns
            behind_ns = clock.now_ns() - deadline_ns
            deadline_ns += period_ns * max(0, behind_ns // period_ns)
            clock.sleep_until_ns(deadline_ns)
    finally:
        node.release()
