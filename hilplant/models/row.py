"""Records of floats and their flat rows: all that is done to a record without naming its elements.

A call into compiled code takes ten times as long with a record as with an array, so arrays are passed, and named again
on the inside. Rows have the order of the declaration (:mod:`hilplant.declaration`), inner records in place; an array at
the end of a record is what is left of the row.

Compiled code may call the six functions below. For it each is written out for the type of its record, which costs what
the same written by hand costs; a translation of the step to another language must do the same:

``unpack(Record, row)``
    ``Record(row[0], Inner(row[1], row[2]), row[3:])``
``write(record, row)``
    ``row[0] = record.x; row[1] = record.inner.y; ...``; an array at the end is not written
``all_finite(record)``
    ``0.0 * (record.x + record.inner.y + ...) == 0.0``, a sum over the elements that are declared as watched; their sum
    must be finite too, which it is below 1e306
``summed(record)``
    ``1.41421356 * record.x + 1.73205081 * record.inner.y + ...``, a sum by which a change of any element is seen
``guarded(record)``
    ``Record(0.0, finite(record.y), ...)``: the constant that is declared, else what :func:`finite` makes of the element
``changed(record, changes)``
    ``Record(record.x, changes.y, record.z)``: what `changes` has, by name, and the others as they are in `record`
"""

import math
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

import numpy as np

from hilplant.arrays import Floats
from hilplant.declaration import Signal, declared, members
from hilplant.jit import Written, compiled, written_out

Record = TypeVar("Record", bound=tuple[Any, ...])


def pack(record: tuple[Any, ...]) -> Floats:
    """Flatten a record, inner ones and arrays in place, into a row of floats."""
    values: list[float] = []
    for field in record:
        values.extend(pack(field) if isinstance(field, tuple) else np.atleast_1d(field).astype(float))
    return np.array(values, dtype=np.float64)


def unpack(record: type[Record], row: Any) -> Record:
    """Give the elements of a packed row their names back; the inverse of :func:`pack`."""
    count = len(declared(record))
    return _filled(record, iter(row[:count].tolist()), row[count:])


def write(record: tuple[Any, ...], row: Any) -> None:
    """Write a record into its row, without an array at its end."""
    count = len(declared(type(record)))
    row[:count] = pack(record)[:count]


def all_finite(record: tuple[Any, ...]) -> bool:
    """Return whether all elements that are watched, and their sum, are finite."""
    signals = declared(type(record))
    return math.isfinite(sum(value for signal, value in zip(signals, pack(record), strict=True) if signal.watched))


def summed(record: tuple[Any, ...]) -> float:
    """Return a sum over all elements, each with a weight of its own: it tells whether any of them has changed."""
    terms = [weight * value for weight, value in zip(_weights(record), pack(record).tolist(), strict=True)]
    while len(terms) > 1:  # as it is written out
        terms = [sum(terms[first + 1 : first + 2], terms[first]) for first in range(0, len(terms), 2)]
    return float(terms[0])


def _weights(record: Any) -> list[float]:
    """Return square roots of whole numbers, so that no two changes that people make cancel each other."""
    return [
        math.sqrt(index + 2.0) for index in range(len(declared(record if isinstance(record, type) else type(record))))
    ]


def guarded(record: Record) -> Record:
    """Return the record with what the guard puts in the place of each element."""
    row = [
        finite(value) if signal.guarded is None else signal.guarded
        for signal, value in zip(declared(type(record)), pack(record), strict=True)
    ]
    return unpack(type(record), np.array(row))


def changed(record: Record, changes: tuple[Any, ...]) -> Record:
    """Return the record with the elements that `changes` has, by name."""
    return type(record)(**record._asdict() | changes._asdict())  # type: ignore[attr-defined]


@compiled
def finite(value: float) -> float:
    """Return the value, or 0 when it is not finite."""
    return value if math.isfinite(value) else 0.0


def _filled(record: type[Record], values: Iterator[float], rest: Any) -> Record:
    kinds = [kind for _, kind in members(record)]
    parts: list[Any] = [
        next(values) if isinstance(kind, Signal) else _filled(kind, values, rest) if kind else rest for kind in kinds
    ]
    return record(*parts)


def _call(record: type[Any], element: Callable[[str], str], prefix: str = "") -> str:
    """Return the expression that makes a record, with the expression of each element by its full name."""
    parts = [
        _call(kind, element, f"{prefix}{name}.") if isinstance(kind, type) else element(prefix + name)
        for name, kind in members(record)
    ]
    return f"{record.__name__}({', '.join(parts)})"


def _classes(record: type[Any]) -> dict[str, Any]:
    found: dict[str, Any] = {record.__name__: record}
    for _, kind in members(record):
        if isinstance(kind, type):
            found |= _classes(kind)
    return found


@written_out(unpack)
def _unpack(record: type[Any], _: None) -> Written:
    index = {signal.name: f"row[{place}]" for place, signal in enumerate(declared(record))}
    return [f"return {_call(record, lambda name: index.get(name, f'row[{len(index)}:]'))}"], _classes(record)


@written_out(write)
def _write(record: type[Any], _: None) -> Written:
    return [f"row[{place}] = record.{signal.name}" for place, signal in enumerate(declared(record))], {}


@written_out(all_finite)
def _all_finite(record: type[Any]) -> Written:
    terms = [f"record.{signal.name}" for signal in declared(record) if signal.watched]
    return [f"return 0.0 * ({_sum_of(terms)}) == 0.0"], {}


def _sum_of(terms: list[str]) -> str:
    """Return sums of sums, so that the processor need not wait for one after the other."""
    while len(terms) > 1:
        terms = [f"({' + '.join(terms[first : first + 2])})" for first in range(0, len(terms), 2)]
    return terms[0]


@written_out(summed)
def _summed(record: type[Any]) -> Written:
    terms = [f"{w!r} * record.{signal.name}" for w, signal in zip(_weights(record), declared(record), strict=True)]
    return [f"return {_sum_of(terms)}"], {}


@written_out(guarded)
def _guarded(record: type[Any]) -> Written:
    puts = {
        signal.name: f"finite(record.{signal.name})" if signal.guarded is None else repr(signal.guarded)
        for signal in declared(record)
    }
    return [f"return {_call(record, lambda name: puts[name])}"], {**_classes(record), "finite": finite}


@written_out(changed)
def _changed(record: type[Any], changes: type[Any]) -> Written:
    foreign = set(changes._fields) - set(record._fields)
    if foreign:
        raise TypeError(f"{record.__name__} has no {', '.join(sorted(foreign))}")
    parts = (f"{name}={'changes' if name in changes._fields else 'record'}.{name}" for name in record._fields)
    return [f"return {record.__name__}({', '.join(parts)})"], {record.__name__: record}
