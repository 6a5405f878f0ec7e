"""Messages of a bus database as functions between payloads and plant values; no socket, no clock.

Both directions take the list of signals as an argument, so that the stand-in ECU uses the same mapping the
other way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hilplant.bus.bits import places
from hilplant.bus.decoding import Decode, decoder
from hilplant.bus.encoding import Encode, encoder
from hilplant.bus.flag_conditions import FlagCondition, LinkedCondition, link_condition
from hilplant.bus.frame_layout import base_payload, check_message, check_overlap, selectors_of
from hilplant.bus.joint_code import Linked, databases_of, split_joint
from hilplant.bus.mapping import MappingError, SignalMapping, link
from hilplant.bus.protection import Protection
from hilplant.units import MILLISECOND_NS

if TYPE_CHECKING:
    from cantools.database.can.message import Message

    from hilplant.declaration import Signal

__all__ = [
    "FlagCondition",
    "Mapped",
    "MappingError",
    "ReceivedMessage",
    "SentMessage",
    "SignalMapping",
    "Timing",
    "received_message",
    "sent_message",
]

#: A line of a mapping: one signal for one, or several for a flag.
Mapped = SignalMapping | FlagCondition


@dataclass(frozen=True, slots=True)
class ReceivedMessage:
    """A message that is taken in.

    `decode` returns a value for each of `targets`, indices into the list of signals; None for a multiplexed
    signal that is not in this frame. A value outside its entry of `limits`, or not a number, must not be
    used. Limits are the narrower of the plant's and the database's range, half a raw step wider, so that a
    value that was rounded on its way over the bus does not fall out.
    """

    name: str
    identifier: int
    extended: bool
    fd: bool
    length: int
    decode: Decode
    targets: tuple[int, ...]
    limits: tuple[tuple[float, float], ...]
    timeout_ns: int = 0
    protection: Protection | None = None
    switches: tuple[int, ...] = ()  # which of `targets` are flags or choices
    j1939: bool = False  # known by its parameter group, from any sender


@dataclass(frozen=True, slots=True)
class SentMessage:
    """A message that is sent.

    `encode` takes the values of the whole list of signals and returns the payload and how many of them were
    limited to what the frame can carry. `sources` are the indices that it reads, `on_change` those whose
    change sends at once.
    """

    name: str
    identifier: int
    extended: bool
    fd: bool
    length: int
    encode: Encode
    sources: tuple[int, ...]
    period_ns: int
    offset_ns: int = 0
    on_change: tuple[int, ...] = ()
    protection: Protection | None = None


@dataclass(frozen=True, slots=True)
class Timing:
    """When a message is sent.

    Each `period_ns` (None: the database's cycle time; 0: never by itself), first after `offset_ns`, and at
    once when one of the plant's signals named in `on_change` changes.
    """

    period_ns: int | None = None
    offset_ns: int = 0
    on_change: tuple[str, ...] = ()


def received_message(
    message: Message,
    mappings: Sequence[Mapped],
    signals: Sequence[Signal],
    timeout_ns: int = 0,
    protection: Protection | None = None,
) -> ReceivedMessage:
    """Build a message to take in from its description in a database, and the mapping of some of its signals.

    `signals` is the list whose values are to be set; `timeout_ns` is 0 where nobody minds its absence.

    Raises
    ------
    MappingError
        Naming the message, the signal, what is wrong and what would be right.

    """
    links = _links(message, mappings, signals)
    _refuse_twice(message, links)
    read = [signal for made in links for signal in databases_of(made)]
    selectors = selectors_of(message, read)
    check_overlap(message, [*selectors.values(), *read], protection)
    return ReceivedMessage(
        message.name,
        message.frame_id,
        message.is_extended_frame,
        message.is_fd,
        message.length,
        decoder(links, selectors, message.length),
        tuple(made.index for made in links),
        tuple(_limits(made) for made in links),
        timeout_ns,
        protection,
        tuple(place for place, made in enumerate(links) if made.plant.kind in ("flag", "choice")),
        message.protocol == "j1939" and message.is_extended_frame,
    )


def sent_message(
    message: Message,
    mappings: Sequence[Mapped],
    signals: Sequence[Signal],
    timing: Timing | None = None,
    protection: Protection | None = None,
) -> SentMessage:
    """Build a message to send; signals that are not mapped carry the database's initial value, or else 0.

    Raises
    ------
    MappingError
        Naming the message, the signal, what is wrong and what would be right.

    """
    timing = timing or Timing()
    links = _links(message, mappings, signals)
    written = [signal for made in links for signal in databases_of(made)]
    for signal in written:
        if signal.multiplexer_signal is not None or signal.is_multiplexer:
            text = "multiplexed signals can be received only; send it in a message of its own"
            raise MappingError(message.name, signal.name, text)
    check_overlap(message, written, protection)
    return SentMessage(
        message.name,
        message.frame_id,
        message.is_extended_frame,
        message.is_fd,
        message.length,
        encoder(*split_joint(message, links), base_payload(message, {at for each in written for at in places(each)})),
        tuple(made.index for made in links),
        _period_ns(message, timing),
        timing.offset_ns,
        tuple(_watched(message, name, signals) for name in timing.on_change),
        protection,
    )


def _links(message: Message, mappings: Sequence[Mapped], signals: Sequence[Signal]) -> list[Linked]:
    check_message(message)
    if not mappings:
        raise MappingError(message.name, None, "no signal is mapped; map one, or leave the message out")
    return [
        link(message, mapping, signals)
        if isinstance(mapping, SignalMapping)
        else link_condition(message, mapping, signals)
        for mapping in mappings
    ]


def _refuse_twice(message: Message, links: Sequence[Linked]) -> None:
    """Refuse a signal of the plant that two mappings write."""
    written = set()
    for made in links:
        target = made.plant.name
        if target in written:
            name = databases_of(made)[0].name
            raise MappingError(message.name, name, f"{target} is written by two mappings; keep one")
        written.add(target)


def _limits(made: Linked) -> tuple[float, float]:
    if isinstance(made, LinkedCondition) or made.table is not None:
        return made.plant.minimum, made.plant.maximum
    slack = 0.0 if made.database.is_float else abs(made.database.scale * made.scale) / 2.0
    lowest, highest = made.bounds
    return max(made.plant.minimum, lowest) - slack, min(made.plant.maximum, highest) + slack


def _period_ns(message: Message, timing: Timing) -> int:
    if timing.period_ns is not None:
        return timing.period_ns
    if not message.cycle_time:
        raise MappingError(message.name, None, "the database states no cycle time; say how often to send it")
    return int(message.cycle_time * MILLISECOND_NS)


def _watched(message: Message, name: str, signals: Sequence[Signal]) -> int:
    for index, signal in enumerate(signals):
        if signal.name == name:
            return index
    known = ", ".join(signal.name for signal in signals)
    raise MappingError(message.name, None, f"on_change names '{name}', which is none of {known}")
