"""Flags of the plant that several signals of a message decide together: on when any, or all, of them say so."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hilplant.bus.bits import type_range
from hilplant.bus.mapping import MappingError, check_database, database_signal, plant_index, raw_number

if TYPE_CHECKING:
    from cantools.database.can.message import Message
    from cantools.database.can.signal import Signal as DatabaseSignal

    from hilplant.declaration import Signal


@dataclass(frozen=True, slots=True)
class ConditionTerm:
    """One signal of the message: true while it has one of these labels or raw numbers; with none, while it is not 0."""

    database_signal: str
    values: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class FlagCondition:
    """A flag of the plant: on while any of `any` (if there are some) and all of `all` are true, else off."""

    plant_signal: str
    any: tuple[ConditionTerm, ...] = ()
    all: tuple[ConditionTerm, ...] = ()


@dataclass(frozen=True, slots=True)
class LinkedTerm:
    """A term that was found to work: true while the raw value is in `raws`, or, without `inside`, while it is not."""

    database: DatabaseSignal
    raws: frozenset[int]
    inside: bool


@dataclass(frozen=True, slots=True)
class LinkedCondition:
    """A condition that was found to work."""

    plant: Signal
    index: int
    any: tuple[LinkedTerm, ...]
    all: tuple[LinkedTerm, ...]

    def databases(self) -> Iterator[DatabaseSignal]:
        """Return the database's signals that decide."""
        for term in (*self.any, *self.all):
            yield term.database

    def value(self, raws: Mapping[str, int]) -> float:
        """Return the flag for raw values by the signals' names."""
        some = [(raws[term.database.name] in term.raws) == term.inside for term in self.any]
        every = [(raws[term.database.name] in term.raws) == term.inside for term in self.all]
        return float((any(some) or not some) and all(every))


def link_condition(message: Message, condition: FlagCondition, signals: Sequence[Signal]) -> LinkedCondition:
    """Look up what a condition names and check that it can work.

    Raises
    ------
    MappingError
        When a signal, label or number is unknown, or what is decided is no flag.

    """
    index = plant_index(message, condition.plant_signal, None, signals)
    plant = signals[index]
    if plant.kind != "flag":
        text = f"{plant.name} is a {plant.kind}, and a condition gives a flag"
        raise MappingError(message.name, None, text)
    if not condition.any and not condition.all:
        raise MappingError(message.name, None, f"the condition of {plant.name} names no signal; give any or all")
    some, every = (tuple(_term(message, term) for term in terms) for terms in (condition.any, condition.all))
    return LinkedCondition(plant, index, some, every)


def _term(message: Message, term: ConditionTerm) -> LinkedTerm:
    database = database_signal(message, term.database_signal)
    try:
        check_database(database)
        if database.is_float:
            raise ValueError("a float cannot decide a condition")
        raws = frozenset(raw_number(database, value) for value in term.values)
        lowest, highest = type_range(database)
        if len(raws) > highest - lowest:
            raise ValueError("the condition names all of its values, so it decides nothing")
    except ValueError as error:
        raise MappingError(message.name, database.name, str(error)) from error
    return LinkedTerm(database, raws or frozenset({0}), bool(raws))
