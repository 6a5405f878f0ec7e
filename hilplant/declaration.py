"""How a record declares its elements: unit, range and meaning stand in the annotation of each.

A record is a NamedTuple whose elements are floats or records; its last element may be an array. Everything else follows
from the declaration: packed rows and the guard (:mod:`hilplant.models.row`), the lists of signals, the columns of
recordings, the checks of benches and scenarios, the table in the documentation.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

Kind = Literal["real", "flag", "choice", "count"]


@dataclass(frozen=True, slots=True)
class Signal:
    """One element: its name, unit, permitted range (inclusive), meaning, and value until something else is said.

    A count never falls; where it outgrows its frame it stays at the highest value, or begins again at 0 if it `wraps`:
    neither is a fault. A real signal may have names for some of its values. The guard looks whether the element is
    finite if it is `watched`; once it is set it puts `guarded` in its place, or if that is None, keeps a finite number
    and makes any other 0.
    """

    name: str
    unit: str
    minimum: float
    maximum: float
    meaning: str
    kind: Kind = "real"
    default: float = 0.0
    choices: tuple[str, ...] = ()
    names: tuple[tuple[str, float], ...] = ()
    watched: bool = True
    guarded: float | None = None
    wraps: bool = False


Names = tuple[tuple[str, float], ...]


def real(  # noqa: PLR0913
    unit: str, minimum: float, maximum: float, meaning: str, *, names: Names = (), guarded: float | None = None
) -> Signal:
    """Declare a number within a range."""
    return Signal("", unit, minimum, maximum, meaning, names=names, guarded=guarded)


def quantity(unit: str, meaning: str, *, watched: bool = True, guarded: float | None = None) -> Signal:
    """Declare a number of the plant's own, which has no range that could be told beforehand."""
    return Signal("", unit, -math.inf, math.inf, meaning, watched=watched, guarded=guarded)


def flag(meaning: str, *, watched: bool = True, guarded: float | None = None) -> Signal:
    """Declare what is 0 or 1."""
    return Signal("", "", 0.0, 1.0, meaning, "flag", watched=watched, guarded=guarded)


def choice(choices: tuple[str, ...], meaning: str, *, watched: bool = True, guarded: float | None = None) -> Signal:
    """Declare the index of a name among `choices`."""
    return Signal("", "", 0.0, len(choices) - 1.0, meaning, "choice", choices=choices, watched=watched, guarded=guarded)


def count(meaning: str, unit: str = "", maximum: float = 2.0**53, *, wraps: bool = False) -> Signal:
    """Declare what only grows."""
    return Signal("", unit, 0.0, maximum, meaning, "count", wraps=wraps)


def members(record: type[Any]) -> tuple[tuple[str, Any], ...]:
    """Return name and declaration of each element: a Signal, an inner record's type, or None for an array."""
    key: Any = record
    return _listed(key)


@cache
def _listed(record: Any) -> tuple[tuple[str, Any], ...]:
    return tuple(_members(record))


def _members(record: type[Any]) -> Iterator[tuple[str, Any]]:
    for name, hint in get_type_hints(record, include_extras=True).items():
        signal = next((each for each in get_args(hint) if isinstance(each, Signal)), None)
        if signal is not None and get_origin(hint) is Annotated:
            default = record._field_defaults.get(name, 0.0)
            yield name, replace(signal, name=name, default=default)
        elif hasattr(hint, "_fields"):
            yield name, hint
        elif hint is Any:
            yield name, None
        else:
            raise TypeError(f"{record.__name__}.{name} is not declared: write Annotated[float, real(...)] or the like")


def declared(record: type[Any]) -> tuple[Signal, ...]:
    """Return all elements of a record in the order of its packed row; those of inner records are `inner.name`.

    An array at the end has no place that could be told, and is left out.
    """
    kind: Any = record  # of whose type the cache must not know
    return _declared(kind)


@cache
def _declared(record: Any) -> tuple[Signal, ...]:
    found: list[Signal] = []
    for name, member in members(record):
        if isinstance(member, Signal):
            found.append(member)
        elif member is not None:
            found.extend(replace(signal, name=f"{name}.{signal.name}") for signal in declared(member))
    return tuple(found)


def index_of(signals: tuple[Signal, ...]) -> dict[str, int]:
    """Return the index of each signal by its name."""
    return {signal.name: index for index, signal in enumerate(signals)}
