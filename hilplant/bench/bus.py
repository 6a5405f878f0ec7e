"""The bus of a bench -> the messages of the plant, and what holds when commands are lost."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from hilplant.bench.bus_description import BusSection, CommandEntry, InterfaceSection, ReceivedEntry, SentEntry
from hilplant.bench.database import Database, read_database
from hilplant.bench.mapping import MappedMessage, framed, map_message
from hilplant.bench.timing import sending, timeout_ns
from hilplant.bench.values import signal_values
from hilplant.bus.codec import ReceivedMessage, SentMessage, received_message, sent_message
from hilplant.bus.mapping import MappingError
from hilplant.bus.transport import wrong_interface
from hilplant.checked_yaml.spot import Spot
from hilplant.declaration import Signal
from hilplant.signals import INPUT_INDEX, INPUTS, PUBLISHED

#: What the relays become while commands are lost, unless a bench names them.
RELAYS_OPEN = {"relay_on": False, "relay_fast": False}

Built = TypeVar("Built")
Received = tuple[MappedMessage, ReceivedMessage]
Sent = tuple[MappedMessage, SentMessage]


@dataclass(frozen=True, slots=True)
class Bus:
    """Everything about the bus; `commands` and `reports` are what the stand-in ECU's side is built from."""

    interface: dict[str, Any]
    safe: tuple[tuple[int, float], ...]
    receive: tuple[ReceivedMessage, ...] = ()
    send: tuple[SentMessage, ...] = ()
    commands: tuple[MappedMessage, ...] = ()
    reports: tuple[MappedMessage, ...] = ()
    database: Database | None = None


@dataclass(frozen=True, slots=True)
class MessageBuilder:
    """Builds messages of a database; their entries may name those of the signals from `first` on.

    Messages are sent in multiples of `step_ns`. What is wrong is noted.
    """

    database: Database
    signals: Sequence[Signal]
    first: int = 0
    step_ns: int = 1
    timeout_ms: float | None = None

    def received(self, spot: Spot, entry: ReceivedEntry | None) -> Received | None:
        """Build a message that is taken in."""
        message = self.database.message(spot)
        if message is None or entry is None:
            return None
        message = framed(spot, message, entry)
        mapped = map_message(spot, message, entry, self.signals[self.first :])
        timeout = timeout_ns(spot, message, entry, self.timeout_ms)
        if mapped is None:
            return None
        settings = (self.signals, timeout, mapped.protection)
        return _both(spot, mapped, lambda: received_message(message, mapped.mappings, *settings))

    def sent(self, spot: Spot, entry: SentEntry | None) -> Sent | None:
        """Build a message that is sent."""
        message = self.database.message(spot)
        if message is None or entry is None:
            return None
        message = framed(spot, message, entry)
        mapped = map_message(spot, message, entry, self.signals[self.first :])
        timing = sending(spot, message, entry, self.step_ns, self.signals[self.first :])
        if mapped is None:
            return None
        return _both(
            spot, mapped, lambda: sent_message(message, mapped.mappings, self.signals, timing, mapped.protection)
        )


def build_bus(spot: Spot, bus: BusSection, step_ns: int) -> Bus:
    """Build what is sound of the bus; everything else is noted."""
    interface = _interface(spot.inner("interface"), bus.interface)
    safe = signal_values(RELAYS_OPEN | (bus.safe or {}))
    receive, send = bus.receive or {}, bus.send or {}
    _refuse_two_commanders(spot.inner("receive"), receive)
    database = read_database(spot.inner("database"), bus.database)
    if database is None:
        return Bus(interface, safe)
    database.warn_of_left_out(spot.inner("database"))
    commanded, reported = (
        MessageBuilder(database, INPUTS, timeout_ms=bus.timeout_ms),
        MessageBuilder(database, PUBLISHED, step_ns=step_ns),
    )
    received = [commanded.received(spot.inner("receive", name), entry) for name, entry in receive.items()]
    sent = [reported.sent(spot.inner("send", name), entry) for name, entry in send.items()]
    commands = [pair for pair in received if pair is not None]
    reports = [pair for pair in sent if pair is not None]
    _refuse_one_identifier(spot, [message for _, message in commands], [message for _, message in reports])
    mapped = [mapped for mapped, _ in commands] + [mapped for mapped, _ in reports]
    _refuse_fd_on_classic(spot, interface, mapped)
    return Bus(
        interface,
        safe,
        tuple(message for _, message in commands),
        tuple(message for _, message in reports),
        tuple(mapped for mapped, _ in commands),
        tuple(mapped for mapped, _ in reports),
        database,
    )


def _interface(spot: Spot, section: InterfaceSection | None) -> dict[str, Any]:
    arguments = section.model_dump() if section is not None else {}
    if arguments and (wrong := wrong_interface(arguments)):
        spot.note(text=wrong)
    return arguments


def _both(spot: Spot, mapped: MappedMessage, build: Callable[[], Built]) -> tuple[MappedMessage, Built] | None:
    """Build a message; what is wrong with its signals together is noted at the one that is named."""
    try:
        return mapped, build()
    except MappingError as error:
        spot.note(*(("signals", error.signal) if error.signal else ()), text=str(error))
        return None


def _refuse_two_commanders(receive: Spot, messages: Mapping[str, CommandEntry | None]) -> None:
    """Refuse an input of the plant that two messages would write, whatever else is wrong with them."""
    first: dict[str, tuple[str, str]] = {}
    for message, entry in messages.items():
        for target, keys in entry.targets() if entry is not None else ():
            other, signal = first.setdefault(target, (message, keys[-1]))
            if other != message and target in INPUT_INDEX:
                text = f"{target} is already commanded by {other}.{signal}; keep one of the two"
                receive.note(message, *keys, text=text)


def _refuse_fd_on_classic(bus: Spot, interface: dict[str, Any], messages: list[MappedMessage]) -> None:
    """Refuse FD messages where SocketCAN is not asked for FD frames; other interfaces have their own words for it."""
    names = [mapped.message.name for mapped in messages if mapped.message.is_fd]
    if names and interface.get("interface") == "socketcan" and interface.get("fd") is not True:
        bus.note("interface", text=f"{', '.join(names)}: FD needs 'fd: true' here")


def _refuse_one_identifier(bus: Spot, receive: list[ReceivedMessage], send: list[SentMessage]) -> None:
    """Refuse two messages that could not be told apart."""
    first: dict[tuple[int, bool], str] = {}
    everything: list[tuple[str, ReceivedMessage | SentMessage]] = [("receive", each) for each in receive]
    everything += [("send", each) for each in send]
    for direction, message in everything:
        key = (message.identifier, message.extended)
        if key in first:
            text = f"{message.name} has the identifier 0x{message.identifier:x} of {first[key]}; map one of them"
            bus.note(direction, message.name, text=text)
        first.setdefault(key, message.name)
