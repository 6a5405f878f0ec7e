"""Checks of a message as a whole: its length, who lies over whom, and the bits that nobody maps."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import TYPE_CHECKING

from hilplant.bus.bits import letter, places
from hilplant.bus.mapping import MappingError
from hilplant.bus.protection import Protection

if TYPE_CHECKING:
    from cantools.database.can.message import Message
    from cantools.database.can.signal import Signal as DatabaseSignal

CLASSIC_BYTES = 8
FD_LENGTHS = (*range(9), 12, 16, 20, 24, 32, 48, 64)


def check_message(message: Message) -> None:
    """Refuse messages that are not one frame."""
    if message.is_container:
        raise MappingError(message.name, None, "it is a container of other messages, which is not supported")
    if (secured := getattr(message.autosar, "secoc", None)) is not None:
        text = f"its frames are authenticated by SecOC ({secured.auth_algorithm_name or 'unknown algorithm'})"
        raise MappingError(message.name, None, f"{text}, which is not supported")
    if message.protocol == "j1939" and message.length > CLASSIC_BYTES:
        text = f"J1939 sends its {message.length} bytes in several frames, which is not supported"
        raise MappingError(message.name, None, text)
    if message.is_fd and message.length not in FD_LENGTHS:
        text = f"no FD frame has {message.length} bytes; there are {', '.join(map(str, FD_LENGTHS))}"
        raise MappingError(message.name, None, text)
    if not message.is_fd and message.length > CLASSIC_BYTES:
        text = f"{message.length} bytes need an FD frame, and it is called a classic one"
        raise MappingError(message.name, None, text)


def selectors_of(message: Message, read: Sequence[DatabaseSignal]) -> dict[str, DatabaseSignal]:
    """Return by name the multiplexers that decide whether signals that are read are in a frame."""
    by_name = {signal.name: signal for signal in message.signals}
    found: dict[str, DatabaseSignal] = {}
    for signal in read:
        name = signal.multiplexer_signal
        while name is not None:
            if name not in by_name:
                raise MappingError(message.name, signal.name, f"its multiplexer {name} is not in the database")
            found[name] = by_name[name]
            name = by_name[name].multiplexer_signal
    return found


def check_overlap(message: Message, signals: Sequence[DatabaseSignal], protection: Protection | None) -> None:
    """Refuse mapped signals that do not fit in, share bits, or lie where the protection writes.

    Signals that nobody maps are not looked at: in real databases they do overlap.
    """
    reserved = protection.reserved_places() if protection else frozenset()
    seen: list[DatabaseSignal] = []
    for signal in {signal.name: signal for signal in signals}.values():
        own = set(places(signal))
        if min(own) < 0 or max(own) >= 8 * message.length:
            raise MappingError(message.name, signal.name, f"it does not fit in the frame's {message.length} bytes")
        for other in seen:
            if not own.isdisjoint(places(other)) and not _on_other_page(message, signal, other):
                text = f"it shares bits with {other.name}, which is mapped too; map one of them"
                raise MappingError(message.name, signal.name, text)
        if not own.isdisjoint(reserved):
            text = (
                f"it lies where protection profile {protection.profile} has its header; map another signal, "
                "or correct the protection's offset"
                if protection
                else ""
            )
            raise MappingError(message.name, signal.name, text)
        seen.append(signal)


def _pages(message: Message, signal: DatabaseSignal) -> dict[str, set[int]]:
    """Return the pages on which a signal lies, by multiplexer, outer ones included."""
    by_name = {each.name: each for each in message.signals}
    pages: dict[str, set[int]] = {}
    while signal.multiplexer_signal is not None:
        pages[signal.multiplexer_signal] = set(signal.multiplexer_ids or ())
        signal = by_name[signal.multiplexer_signal]
    return pages


def _on_other_page(message: Message, one: DatabaseSignal, other: DatabaseSignal) -> bool:
    first, second = _pages(message, one), _pages(message, other)
    return any(first[name].isdisjoint(second[name]) for name in first.keys() & second.keys())


def base_payload(message: Message, mapped: set[int]) -> bytes:
    """Return the payload of the signals that are not mapped, at their initial values.

    Places that are `mapped` are 0, and so are those of signals on a page; those that no signal uses have the message's
    pattern of unused bits.
    """
    used = mapped.union(*(places(signal) for signal in message.signals))
    pattern = message.unused_bit_pattern
    whole = sum(1 << place for place in range(8 * message.length) if place not in used and pattern >> place % 8 & 1)
    for signal in message.signals:
        if signal.multiplexer_signal is None:
            raw = _initial_bits(signal)
            free = [(index, place) for index, place in enumerate(places(signal)) if place not in mapped]
            whole |= sum((raw >> index & 1) << place for index, place in free if place < 8 * message.length)
    return whole.to_bytes(message.length, "little")


def _initial_bits(signal: DatabaseSignal) -> int:
    initial = signal.raw_initial or 0
    if signal.is_float:
        return int.from_bytes(struct.pack(f"<{letter(signal)}", initial), "little") if letter(signal) else 0
    return round(initial) & ((1 << signal.length) - 1)
