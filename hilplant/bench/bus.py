"""The bus section of a bench -> the messages of the plant, and what holds when commands are lost."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from hilplant.bench.database import Database, read_database
from hilplant.bench.description import BusSection, InterfaceSection, ReceiveEntry, SendEntry
from hilplant.bench.mapping import MappedMessage, map_message
from hilplant.bench.timing import sending, timeout_ns
from hilplant.bench.values import signal_values
from hilplant.bus.codec import ReceivedMessage, SentMessage, received_message, sent_message
from hilplant.bus.mapping import MappingError
from hilplant.bus.transport import wrong_interface
from hilplant.checked_yaml.place import Place
from hilplant.declaration import Signal
from hilplant.signals import INPUT_INDEX, INPUTS, PUBLISHED

RELAYS_OPEN = {"relay_on": False, "relay_fast": False}

Built = TypeVar("Built")


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


def assemble_bus(bus: Place, step_ns: int) -> Bus:
    """Build what is sound of the bus; everything else is noted."""
    bus.take(BusSection)
    interface = _interface(bus.inner("interface"))
    safe = signal_values(bus.inner("safe"), RELAYS_OPEN)
    _refuse_two_commanders(bus.inner("receive"))
    database = read_database(bus.inner("database"))
    if database is None:
        return Bus(interface, safe)
    received = [receive_entry(place, database, INPUTS) for place in _groups(bus.inner("receive"))]
    sent = [send_entry(place, database, PUBLISHED, step_ns) for place in _groups(bus.inner("send"))]
    commands = [pair for pair in received if pair is not None]
    reports = [pair for pair in sent if pair is not None]
    _refuse_one_identifier(bus, [message for _, message in commands], [message for _, message in reports])
    mapped = [mapped for mapped, _ in commands] + [mapped for mapped, _ in reports]
    _refuse_fd_on_classic(bus, interface, mapped)
    return Bus(
        interface,
        safe,
        tuple(message for _, message in commands),
        tuple(message for _, message in reports),
        tuple(mapped for mapped, _ in commands),
        tuple(mapped for mapped, _ in reports),
        database,
    )


def _interface(place: Place) -> dict[str, Any]:
    data = place.data()
    if not isinstance(data, dict) or place.take(InterfaceSection) is None:
        return {}
    if wrong := wrong_interface(data):
        place.note(text=wrong)
    return dict(data)


def _groups(place: Place) -> Iterator[Place]:
    """Return the groups that stand under the names of messages."""
    data = place.data()
    for name, group in data.items() if isinstance(data, dict) else ():
        if isinstance(group, dict):
            yield place.inner(name)


def receive_entry(
    place: Place, database: Database, signals: Sequence[Signal], first: int = 0
) -> tuple[MappedMessage, ReceivedMessage] | None:
    """Build a message that is taken in; its entry may name those of the signals from `first` on."""
    message, entry = database.message(place), place.take(ReceiveEntry)
    if message is None or entry is None:
        return None
    mapped = map_message(place, message, entry, signals[first:])
    timeout = timeout_ns(place, message, entry)
    if mapped is None:
        return None
    return _both(place, mapped, lambda: received_message(message, mapped.mappings, signals, timeout, mapped.protection))


def send_entry(
    place: Place, database: Database, signals: Sequence[Signal], step_ns: int, first: int = 0
) -> tuple[MappedMessage, SentMessage] | None:
    """Build a message that is sent in multiples of `step_ns`; otherwise as for one that is taken in."""
    message, entry = database.message(place), place.take(SendEntry)
    if message is None or entry is None:
        return None
    mapped = map_message(place, message, entry, signals[first:])
    timing = sending(place, message, entry, step_ns, signals[first:])
    if mapped is None:
        return None
    return _both(place, mapped, lambda: sent_message(message, mapped.mappings, signals, timing, mapped.protection))


def _both(place: Place, mapped: MappedMessage, build: Callable[[], Built]) -> tuple[MappedMessage, Built] | None:
    """Build a message; what is wrong with its signals together is noted at the one that is named."""
    try:
        return mapped, build()
    except MappingError as error:
        place.note(*(("signals", error.signal) if error.signal else ()), text=str(error))
        return None


def _refuse_two_commanders(receive: Place) -> None:
    """Refuse an input of the plant that two messages would write, whatever else is wrong with them."""
    first: dict[str, tuple[str, str]] = {}
    for place in _groups(receive):
        signals = place.inner("signals").data()
        for name, written in signals.items() if isinstance(signals, dict) else ():
            target = written.get("signal") if isinstance(written, dict) else written
            if not isinstance(target, str) or target not in INPUT_INDEX:
                continue
            message, signal = first.setdefault(target, (place.name, name))
            if message != place.name:
                text = f"{target} is already commanded by {message}.{signal}; keep one of the two"
                place.note("signals", name, text=text)


def _refuse_fd_on_classic(bus: Place, interface: dict[str, Any], messages: list[MappedMessage]) -> None:
    """Refuse FD messages where SocketCAN is not asked for FD frames; other interfaces have their own words for it."""
    names = [mapped.message.name for mapped in messages if mapped.message.is_fd]
    if names and interface.get("interface") == "socketcan" and interface.get("fd") is not True:
        bus.note("interface", text=f"{', '.join(names)}: FD needs 'fd: true' here")


def _refuse_one_identifier(bus: Place, receive: list[ReceivedMessage], send: list[SentMessage]) -> None:
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
