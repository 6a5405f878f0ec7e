"""One message of the bus database as the bench maps it, checked before a direction is chosen for it.

What the plant receives, the stand-in ECU sends, with the same mapping read the other way; so a mapped message
is kept in a form that both are built from.
"""

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from hilplant.bench.bus_description import FrameEntry, ReceivedEntry, SentEntry
from hilplant.bench.mapping_description import ConditionEntry, SignalEntry
from hilplant.bench.unit_doubts import unit_doubt
from hilplant.bus.codec import Mapped
from hilplant.bus.flag_conditions import ConditionTerm, FlagCondition, link_condition
from hilplant.bus.frame_layout import FD_LENGTHS
from hilplant.bus.mapping import MappingError, SignalMapping, link
from hilplant.bus.protection import Protection, ProtectionError
from hilplant.checked_yaml.problems import suggestion
from hilplant.checked_yaml.spot import Spot
from hilplant.declaration import Signal


@dataclass(frozen=True, slots=True)
class MappedMessage:
    """A message, its mapped signals and its protection."""

    message: Any
    mappings: tuple[Mapped, ...]
    protection: Protection | None


def framed(spot: Spot, message: Any, entry: FrameEntry) -> Any:
    """Return the message as its frames are on the bus: classic or FD, and padded to a length that frames have."""
    on_bus = copy.copy(message)
    on_bus.is_fd = message.is_fd if entry.fd is None else entry.fd
    fitting = (length for length in FD_LENGTHS if length >= message.length)
    on_bus.unused_bit_pattern = entry.padding
    on_bus.length = entry.bytes or (next(fitting, message.length) if on_bus.is_fd else message.length)
    if on_bus.length < message.length:
        spot.note("bytes", text=f"{message.name} has {message.length} bytes in the database, so never {entry.bytes}")
    return on_bus


def map_message(
    spot: Spot, message: Any, entry: ReceivedEntry | SentEntry, signals: Sequence[Signal]
) -> MappedMessage | None:
    """Look up and check every mapped signal; None when any cannot work. Units that contradict are a warning."""
    mappings: list[Mapped | None] = [
        _mapping(spot, message, (name, written), signals) for name, each in entry.signals.items() for written in each
    ]
    if isinstance(entry, ReceivedEntry):
        mappings += [_condition(spot, message, named, signals) for named in entry.conditions.items()]
    sound = tuple(mapping for mapping in mappings if mapping is not None)
    try:
        settings = entry.protection.settings() if entry.protection is not None else None
        protection = Protection.from_settings(settings, message.length) if settings is not None else None
    except ProtectionError as error:
        spot.note("protection", text=f"{message.name}: {error}")
        return None
    return MappedMessage(message, sound, protection) if len(sound) == len(mappings) else None


def _mapping(
    spot: Spot, message: Any, named: tuple[str, SignalEntry | None], signals: Sequence[Signal]
) -> SignalMapping | None:
    name, entry = named
    if entry is None or not _known(spot.inner("signals"), message, (name, name, entry.signal), signals):
        return None
    mapping = SignalMapping(name, entry.signal, entry.scale, entry.offset, entry.choices, entry.invert)
    try:
        made = link(message, mapping, signals)
    except MappingError as error:
        spot.note("signals", name, text=f"{message.name}.{name}: {error.text}")
        return None
    if doubt := unit_doubt(made, mapping):
        spot.warn("signals", name, text=f"{message.name}.{name}: {doubt}")
    return mapping


def _condition(
    spot: Spot, message: Any, named: tuple[str, ConditionEntry | None], signals: Sequence[Signal]
) -> FlagCondition | None:
    name, entry = named
    if entry is None:
        return None
    terms = [*entry.any, *entry.all]
    inner = spot.inner("conditions")
    if not all(_known(inner, message, (name, each, name), signals) for each in map(_signal_of, terms)):
        return None
    condition = FlagCondition(name, tuple(map(_term, entry.any)), tuple(map(_term, entry.all)))
    try:
        link_condition(message, condition, signals)
    except MappingError as error:
        inner.note(name, text=f"{message.name}.{error.signal or name}: {error.text}")
        return None
    return condition


def _signal_of(term: str | dict[str, list[str]]) -> str:
    return term if isinstance(term, str) else next(iter(term))


def _term(term: str | dict[str, list[str]]) -> ConditionTerm:
    return ConditionTerm(term) if isinstance(term, str) else ConditionTerm(_signal_of(term), tuple(*term.values()))


def _known(spot: Spot, message: Any, ends: tuple[str, str, str], signals: Sequence[Signal]) -> bool:
    """Say whether both ends of a mapping exist; note at its key what was probably meant where one does not."""
    key, name, plant_name = ends
    in_database = [signal.name for signal in message.signals]
    in_plant = [signal.name for signal in signals]
    if name not in in_database:
        spot.note(key, text=f"{message.name} has no signal '{name}'{suggestion(name, in_database)}")
    elif in_database.count(name) > 1:
        spot.note(key, text=f"{message.name} has {in_database.count(name)} signals '{name}'; keep one")
    elif plant_name not in in_plant:
        text = f"the plant has no signal '{plant_name}' here{suggestion(plant_name, in_plant)}"
        spot.note(key, text=text)
    else:
        return True
    return False
