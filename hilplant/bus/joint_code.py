"""Signals of a message that share what they say of the plant, encoded together.

An enum that drives both relays, or bits that are joined by a condition, cannot be encoded one by one: the raw values
are looked up for all values of the plant at once. The table is found by decoding every combination of raw values that
can matter, so that it is the inverse of decoding by construction.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

from hilplant.bus.bits import raw_range
from hilplant.bus.flag_conditions import LinkedCondition
from hilplant.bus.mapping import Link, MappingError, can_carry, raw_of

if TYPE_CHECKING:
    from cantools.database.can.message import Message
    from cantools.database.can.signal import Signal as DatabaseSignal

    from hilplant.declaration import Signal

#: So many combinations of raw values are tried.
MOST_COMBINATIONS = 100_000

Linked = Link | LinkedCondition


@dataclass(frozen=True, slots=True)
class JointCode:
    """Raw values of some signals for the values of the plant at `indices`, by all that can be said."""

    signals: tuple[DatabaseSignal, ...]
    indices: tuple[int, ...]
    table: Mapping[tuple[float, ...], tuple[int, ...]]

    def nearest(self, values: Sequence[float]) -> tuple[int, ...]:
        """Return what comes nearest to values that cannot be said; between two, that which switches less on."""
        wanted = [0.0 if math.isnan(value) else value for value in values]

        def distance(known: tuple[float, ...]) -> tuple[float, float]:
            return sum(abs(one - other) for one, other in zip(known, wanted, strict=True)), sum(known)

        return self.table[min(self.table, key=distance)]


def split_joint(message: Message, linked: Sequence[Linked]) -> tuple[list[Link], list[JointCode]]:
    """Return the links that stand alone, and the codes of those that share signals of the message.

    Raises
    ------
    MappingError
        When values of the plant cannot be told from raw values; decoding may work all the same.

    """
    alone: list[Link] = []
    codes = []
    for group in _groups(linked):
        first = group[0]
        if len(group) == 1 and isinstance(first, Link):
            alone.append(first)
        else:
            codes.append(_joint_code(message, group))
    return alone, codes


def _groups(linked: Sequence[Linked]) -> list[list[Linked]]:
    """Return what shares signals, directly or by others, in groups."""
    groups: list[tuple[set[str], list[Linked]]] = []
    for each in linked:
        names, members = set(_names(each)), [each]
        for group in [group for group in groups if group[0] & names]:
            names |= group[0]
            members = [*group[1], *members]
            groups.remove(group)
        groups.append((names, members))
    return [members for _, members in groups]


def _names(linked: Linked) -> Iterator[str]:
    return (signal.name for signal in databases_of(linked))


def databases_of(linked: Linked) -> list[DatabaseSignal]:
    """Return the database's signals that are read for a value of the plant."""
    return [linked.database] if isinstance(linked, Link) else list(linked.databases())


def _joint_code(message: Message, group: Sequence[Linked]) -> JointCode:
    signals = {signal.name: signal for each in group for signal in databases_of(each)}
    tables = [_table(message, each) for each in group]
    candidates = [_candidates(name, group, tables) for name in signals]
    first = next(iter(signals))
    if math.prod(map(len, candidates)) > MOST_COMBINATIONS:
        text = (
            f"{', '.join(signals)} have more than {MOST_COMBINATIONS} combinations of values; they can be received only"
        )
        raise MappingError(message.name, first, text)
    found: dict[tuple[float, ...], tuple[int, ...]] = {}
    for backwards in product(*reversed(candidates)):  # of several ways, the one by the signal that is named first
        raws = backwards[::-1]
        by_name = dict(zip(signals, raws, strict=True))
        found.setdefault(tuple(_value(each, table, by_name) for each, table in zip(group, tables, strict=True)), raws)
    _refuse_missing(message, first, group, found)
    return JointCode(tuple(signals.values()), tuple(each.index for each in group), found)


def _table(message: Message, linked: Linked) -> dict[int, float]:
    """Return the plant's value for each raw value of a link; nothing for a condition."""
    if isinstance(linked, LinkedCondition):
        return {}
    if linked.table is not None:
        return linked.table
    if linked.plant.kind not in ("flag", "choice"):
        text = f"it carries {linked.plant.name} as a number, so nothing else can be sent in it; it can be received only"
        raise MappingError(message.name, linked.database.name, text)
    values = [float(value) for value in range(int(linked.plant.minimum), int(linked.plant.maximum) + 1)]
    return {raw_of(linked, value): value for value in values if can_carry(linked, value)}


def _candidates(name: str, group: Sequence[Linked], tables: Sequence[dict[int, float]]) -> list[int]:
    """Return the raw values of a signal that make a difference, those at rest first."""
    own = [
        table for each, table in zip(group, tables, strict=True) if isinstance(each, Link) if each.database.name == name
    ]
    if own:
        return [raw for raw in own[0] if all(raw in table for table in own)]
    terms = [term for each in group if isinstance(each, LinkedCondition) for term in (*each.any, *each.all)]
    terms = [term for term in terms if term.database.name == name]
    named = sorted({raw for term in terms for raw in term.raws})
    lowest, highest = (int(end) for end in raw_range(terms[0].database))
    others = (raw for raw in (0, *range(max(lowest, 1), highest + 1), *range(lowest, 0)) if lowest <= raw <= highest)
    other = next((raw for raw in others if raw not in named), None)
    found = [*named, *([other] if other is not None else [])]
    return sorted(found, key=lambda raw: (raw != 0, raw))


def _value(linked: Linked, table: Mapping[int, float], raws: Mapping[str, int]) -> float:
    return linked.value(raws) if isinstance(linked, LinkedCondition) else table[raws[linked.database.name]]


def _refuse_missing(
    message: Message, name: str, group: Sequence[Linked], found: Mapping[tuple[float, ...], tuple[int, ...]]
) -> None:
    """Refuse what leaves values of the plant without raw values.

    Which brush is chosen means nothing while the motor is off, so nobody needs to say fast and off.
    """
    plants = [each.plant for each in group]
    each_value = [sorted({values[place] for values in found} | _all_of(plant)) for place, plant in enumerate(plants)]
    for values in product(*each_value):
        named = {plant.name: value for plant, value in zip(plants, values, strict=True)}
        if values not in found and not (named.get("relay_on") == 0.0 and named.get("relay_fast") == 1.0):
            text = " and ".join(_said(plant, value) for plant, value in zip(plants, values, strict=True))
            raise MappingError(message.name, name, f"no values of {_listed(group)} say {text}, so it cannot be sent")


def _all_of(plant: Signal) -> set[float]:
    if plant.kind not in ("flag", "choice"):
        return set()
    return {float(value) for value in range(int(plant.minimum), int(plant.maximum) + 1)}


def _said(plant: Signal, value: float) -> str:
    if plant.kind == "flag":
        return f"{plant.name} {'on' if value else 'off'}"
    return f"{plant.name} {plant.choices[int(value)] if plant.kind == 'choice' else f'{value:g}'}"


def _listed(group: Sequence[Linked]) -> str:
    return ", ".join(dict.fromkeys(name for each in group for name in _names(each)))
