"""Ties one signal of a bus database to one signal of the plant, and refuses what cannot work."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hilplant.bus.bits import letter, raw_range, type_range
from hilplant.failure import Failure

if TYPE_CHECKING:
    from cantools.database.can.message import Message
    from cantools.database.can.signal import Signal as DatabaseSignal

    from hilplant.declaration import Signal

#: Names of a flag's two values that a choice may be mapped to.
FLAG_LABELS = {"off": 0.0, "false": 0.0, "0": 0.0, "on": 1.0, "true": 1.0, "1": 1.0}

#: A raw value as text.
_WHOLE = re.compile(r"-?[0-9]{1,20}")

#: What a raw value that no choice stands for becomes: below the range of every signal that choices may lead to.
NO_CHOICE = -2.0


class MappingError(Failure):
    """A mapping between a bus database and the plant that cannot work."""

    def __init__(self, message: str, signal: str | None, text: str) -> None:
        super().__init__(f"{message}.{signal}: {text}" if signal else f"{message}: {text}")
        self.message = message
        self.signal = signal
        self.text = text


@dataclass(frozen=True, slots=True)
class SignalMapping:
    """One line of a mapping: plant value = database's physical value * scale + offset, in both directions.

    `choices` leads from the labels of the database's value table, or raw numbers, to those of the plant's choice (of a
    flag: off, on; of a number that has names: those). `invert` swaps 0 and 1 of a flag.
    """

    database_signal: str
    plant_signal: str
    scale: float = 1.0
    offset: float = 0.0
    choices: Mapping[str, str] | None = None
    invert: bool = False


@dataclass(frozen=True, slots=True)
class Link:
    """A mapping that was found to work.

    `table` holds the plant's value for each raw value where choices decide; otherwise `scale` and `offset`,
    in which an inversion is already contained, lead from the physical value to the plant's. `bounds` are the
    lowest and highest value in the plant's terms that the database permits.
    """

    database: DatabaseSignal
    plant: Signal
    index: int
    scale: float
    offset: float
    table: dict[int, float] | None
    bounds: tuple[float, float]


def link(message: Message, mapping: SignalMapping, signals: Sequence[Signal]) -> Link:
    """Look both ends of a mapping up and check that values can pass between them.

    Raises
    ------
    MappingError
        When an end is unknown, or choices, kind or range do not fit.

    """
    database = database_signal(message, mapping.database_signal)
    index = plant_index(message, mapping.plant_signal, database.name, signals)
    plant = signals[index]
    try:
        check_database(database)
        scale, offset = _line(mapping, plant)
        table = _table(database, plant, mapping)
        bounds = _table_bounds(table) if table else _line_bounds(database, scale, offset)
        made = Link(database, plant, index, scale, offset, table, bounds)
        _check_kind(made)
    except ValueError as error:
        raise MappingError(message.name, database.name, str(error)) from error
    return made


def plant_index(message: Message, name: str, database_name: str | None, signals: Sequence[Signal]) -> int:
    """Return the index of one of the plant's signals."""
    for index, signal in enumerate(signals):
        if signal.name == name:
            return index
    known = ", ".join(signal.name for signal in signals)
    raise MappingError(message.name, database_name, f"the plant has no signal '{name}' here; it has {known}")


def database_signal(message: Message, name: str) -> DatabaseSignal:
    """Return a signal of the message."""
    for signal in message.signals:
        if signal.name == name:
            return signal
    known = ", ".join(signal.name for signal in message.signals)
    raise MappingError(message.name, name, f"the message has no such signal; it has {known or 'none'}")


def check_database(database: DatabaseSignal) -> None:
    """Refuse a signal that the database describes in a way that no value can pass through."""
    stated = (database.scale, database.offset, database.minimum or 0.0, database.maximum or 0.0)
    if not all(math.isfinite(number) for number in stated):
        raise ValueError("its factor, offset or range in the database is beyond every number")
    if database.scale == 0:
        raise ValueError("its factor in the database is 0, so it cannot carry a value")
    if database.is_float and letter(database) is None:
        raise ValueError(f"no float has {database.length} bits; there are 16, 32, 64")


def _line(mapping: SignalMapping, plant: Signal) -> tuple[float, float]:
    """Return scale and offset with the inversion of a flag contained."""
    if mapping.scale == 0.0:
        raise ValueError("scale must not be 0")
    if not mapping.invert:
        return mapping.scale, mapping.offset
    if plant.kind != "flag":
        raise ValueError(f"only a flag can be inverted, and {plant.name} is a {plant.kind}")
    return -mapping.scale, 1.0 - mapping.offset


def _table(database: DatabaseSignal, plant: Signal, mapping: SignalMapping) -> dict[int, float] | None:
    """Return the plant's value for each raw value; None where numbers are mapped by their value."""
    labels = {str(label): int(raw) for raw, label in (database.choices or {}).items()}
    chosen = _same_labels(database, plant, mapping) if mapping.choices is None else dict(mapping.choices)
    if mapping.choices is None and not chosen and (plant.kind != "choice" or not labels):
        return None
    if mapping.choices == {}:
        raise ValueError("choices must name at least one label; leave them out to map numbers")
    if (mapping.scale, mapping.offset) != (1.0, 0.0):
        raise ValueError("choices take no scale and no offset")
    if database.is_float:
        raise ValueError("a float cannot carry choices")
    values = _plant_values(plant)
    table = {raw_number(database, label): _value(values, plant, name) for label, name in chosen.items()}
    if missing := [name for name in plant.choices if float(plant.choices.index(name)) not in table.values()]:
        has = ", ".join(labels) or "its values"
        raise ValueError(f"choices must say which of {has} stands for {', '.join(missing)} of {plant.name}")
    return {raw: 1.0 - value for raw, value in table.items()} if mapping.invert else table


def _same_labels(database: DatabaseSignal, plant: Signal, mapping: SignalMapping) -> dict[str, str]:
    """Return which labels of the database are those of the plant, whatever their case, where no choices are given.

    A number with names is taken by its value as long as the labels agree with the values, and where it is scaled.
    """
    labels = {str(label).lower(): str(label) for label in (database.choices or {}).values()}
    if plant.kind == "choice":
        return {labels[name]: name for name in plant.choices if name in labels}
    scaled = (mapping.scale, mapping.offset) != (1.0, 0.0)
    known = {} if scaled else {labels[name]: value for name, value in plant.names if name in labels}
    raws = {str(label): int(raw) for raw, label in (database.choices or {}).items()}
    agree = all(raws[label] * database.scale + database.offset == value for label, value in known.items())
    return {} if agree else {label: label.lower() for label in known}


def _plant_values(plant: Signal) -> dict[str, float]:
    if plant.kind == "flag":
        return FLAG_LABELS
    if plant.kind == "choice":
        return {name: float(index) for index, name in enumerate(plant.choices)}
    if plant.names:
        return dict(plant.names)
    raise ValueError(f"choices are for a flag, a choice or a number with names, and {plant.name} is a {plant.kind}")


def raw_number(database: DatabaseSignal, label: str) -> int:
    """Return the raw value that a label of the signal's value table, or a number, stands for."""
    labels = {str(text): int(raw) for raw, text in (database.choices or {}).items()}
    number = int(label) if _WHOLE.fullmatch(label) else None
    if label in labels:
        if number is not None and number != labels[label]:
            raise ValueError(
                f"'{label}' is the label of {labels[label]}, and a number too; it cannot be told which is meant"
            )
        return labels[label]
    if number is None:
        has = ", ".join(labels) or "no value table; name the raw numbers"
        raise ValueError(f"its value table has no '{label}'; it has {has}")
    lowest, highest = type_range(database)
    if not lowest <= number <= highest:
        raise ValueError(f"it has {database.length} bits for {lowest:g} to {highest:g}, so never {number}")
    return number


def _value(values: dict[str, float], plant: Signal, name: str) -> float:
    if name.lower() not in values:
        raise ValueError(f"{plant.name} has no choice '{name}'; it has {', '.join(values)}")
    return values[name.lower()]


def _table_bounds(table: dict[int, float]) -> tuple[float, float]:
    return min(table.values()), max(table.values())


def _line_bounds(database: DatabaseSignal, scale: float, offset: float) -> tuple[float, float]:
    lowest, highest = raw_range(database)
    ends = [(raw * database.scale + database.offset) * scale + offset for raw in (lowest, highest)]
    return min(ends), max(ends)


def _check_kind(made: Link) -> None:
    """Refuse numbers that can never be a value of the plant's signal, or not all of its values."""
    plant, (lowest, highest) = made.plant, made.bounds
    low, high = plant.minimum, plant.maximum
    if plant.kind in ("flag", "choice"):
        if not _is_whole(made):
            raise ValueError(f"{plant.name} is a {plant.kind}, so whole numbers must arrive; give choices or a scale")
        if missing := [value for value in range(int(low), int(high) + 1) if not can_carry(made, value)]:
            text = ", ".join(str(value) for value in missing)
            raise ValueError(f"it cannot carry {text} of {plant.name}, which takes all of {low:g} to {high:g}")
    elif lowest > high or highest < low:
        unit = f" {plant.unit}" if plant.unit else ""
        raise ValueError(
            f"after scaling it carries {lowest:g} to {highest:g}{unit}, never within {plant.name}'s "
            f"{low:g} to {high:g}{unit}"
        )


def _is_whole(made: Link) -> bool:
    """Say whether nothing but whole numbers can arrive at the plant."""
    steps = (made.database.scale * made.scale, made.database.offset * made.scale + made.offset)
    return made.table is not None or (not made.database.is_float and all(float(step).is_integer() for step in steps))


def can_carry(made: Link, value: float) -> bool:
    """Say whether a raw value stands for this value of the plant."""
    if made.table is not None:
        return value in made.table.values()
    raw = ((value - made.offset) / made.scale - made.database.offset) / made.database.scale
    lowest, highest = raw_range(made.database)
    return raw.is_integer() and lowest <= raw <= highest


def raw_of(made: Link, value: float) -> int:
    """Return the raw value that stands for a value of the plant, where no table decides."""
    return int(((value - made.offset) / made.scale - made.database.offset) / made.database.scale)
