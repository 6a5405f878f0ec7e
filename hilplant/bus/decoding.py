"""Builds the function that turns a payload into values of the plant: straight-line Python, compiled once.

Its results equal those of cantools, which walks through a description of the message for every frame.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hilplant.bus.bits import is_whole_bytes, letter, places, struct_format
from hilplant.bus.flag_conditions import LinkedCondition
from hilplant.bus.joint_code import Linked, databases_of
from hilplant.bus.mapping import NO_CHOICE, Link

if TYPE_CHECKING:
    from cantools.database.can.signal import Signal as DatabaseSignal

Decode = Callable[[bytes], tuple[float | None, ...]]


class _Source:
    """The function's text and the objects that it refers to by name."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.names: dict[str, Any] = {"from_bytes": int.from_bytes}

    def refer(self, thing: Any) -> str:
        name = f"c{len(self.names)}"
        self.names[name] = thing
        return name


def decoder(links: Sequence[Linked], selectors: Mapping[str, DatabaseSignal], length: int) -> Decode:
    """Return a function from a payload of `length` bytes to the plant's values, in the order of `links`.

    `selectors` are the multiplexers by name; a value whose page is not in the frame is None.
    """
    source = _Source()
    read = {signal.name: signal for link in links for signal in databases_of(link)} | dict(selectors)
    raws = _raws(source, list(read.values()), length)
    values = ", ".join(_value(source, link, raws, selectors) for link in links)
    text = "\n    ".join(["def decode(data):", *source.lines, f"return ({values},)"])
    exec(compile(text, "<decode>", "exec"), source.names)
    decode: Decode = source.names["decode"]
    return decode


def _raws(source: _Source, signals: list[DatabaseSignal], length: int) -> dict[str, str]:
    """Write the lines that fetch the raw values; return their names by signal."""
    raws = {signal.name: f"r{index}" for index, signal in enumerate(signals)}
    rest = list(signals)
    for order in ("little_endian", "big_endian"):
        aligned = _apart([s for s in signals if s.byte_order == order and is_whole_bytes(s)])
        if aligned:
            unpack = source.refer(struct.Struct(struct_format(aligned, length)).unpack)
            source.lines.append("".join(f"{raws[s.name]}, " for s in aligned) + f"= {unpack}(data)")
            rest = [signal for signal in rest if signal not in aligned]
    source.lines += [f"{raws[signal.name]} = {_extract(source, signal)}" for signal in rest]
    return raws


def _apart(signals: list[DatabaseSignal]) -> list[DatabaseSignal]:
    """Return signals in order of place, without those that lie over an earlier one (on another page)."""
    kept: list[DatabaseSignal] = []
    taken: set[int] = set()
    for signal in sorted(signals, key=lambda signal: min(places(signal))):
        if taken.isdisjoint(places(signal)):
            kept.append(signal)
            taken.update(places(signal))
    return kept


def _extract(source: _Source, signal: DatabaseSignal) -> str:
    """Return the expression of a raw value that no struct format reads."""
    where = places(signal)
    first, last = min(where) // 8, max(where) // 8
    order = "little" if signal.byte_order == "little_endian" else "big"
    whole = f"data[{first}]" if first == last else f"from_bytes(data[{first}:{last + 1}], '{order}')"
    bits = f"({whole} >> {where[0] % 8} & {(1 << signal.length) - 1})"
    if signal.is_float:
        unpack = source.refer(struct.Struct(f"<{letter(signal)}").unpack)
        return f"{unpack}({bits}.to_bytes({signal.length // 8}, 'little'))[0]"
    half = 1 << signal.length - 1
    return f"({bits} ^ {half}) - {half}" if signal.is_signed else bits


def _value(source: _Source, link: Linked, raws: Mapping[str, str], selectors: Mapping[str, DatabaseSignal]) -> str:
    if isinstance(link, LinkedCondition):
        value = _decided(source, link, raws)
    else:
        raw = raws[link.database.name]
        value = f"{source.refer(link.table)}.get({raw}, {NO_CHOICE})" if link.table else _scaled(link, raw)
    pages = [page for signal in databases_of(link) for page in _conditions(signal, raws, selectors)]
    return f"({value} if {' and '.join(dict.fromkeys(pages))} else None)" if pages else value


def _decided(source: _Source, link: LinkedCondition, raws: Mapping[str, str]) -> str:
    """Return the expression of a flag that several signals decide."""
    some, every = (
        [f"{raws[t.database.name]} {'in' if t.inside else 'not in'} {source.refer(t.raws)}" for t in terms]
        for terms in (link.any, link.all)
    )
    needed = [f"({' or '.join(some)})"] if some else []
    return f"(1.0 if {' and '.join([*needed, *every])} else 0.0)"


def _scaled(link: Link, raw: str) -> str:
    """Return the expression of a scaled value; cantools' own order of operations comes first."""
    scale, offset = link.database.scale, link.database.offset
    value = raw if (scale, offset) == (1, 0) else f"({raw} * {scale!r} + {offset!r})"
    is_float = link.database.is_float or isinstance(scale, float) or isinstance(offset, float)
    if link.scale != 1.0 or not is_float:
        value = f"{value} * {float(link.scale)!r}"
    return f"{value} + {float(link.offset)!r}" if link.offset != 0.0 else value


def _conditions(signal: DatabaseSignal, raws: Mapping[str, str], selectors: Mapping[str, DatabaseSignal]) -> list[str]:
    """Return what must hold for a signal's page to be in the frame, the outermost multiplexer first."""
    if signal.multiplexer_signal is None:
        return []
    selector = selectors[signal.multiplexer_signal]
    pages = ", ".join(str(page) for page in signal.multiplexer_ids or ())
    return [*_conditions(selector, raws, selectors), f"{raws[selector.name]} in {{{pages}}}"]
