"""Builds the function that turns values of the plant into a payload: straight-line Python, compiled once.

Its bytes equal those of cantools. Values beyond what a signal may carry are limited, never refused, because
the loop must go on; how many were limited is returned beside the payload.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from hilplant.bus.bits import is_whole_bytes, letter, places, raw_range, struct_format
from hilplant.bus.joint_code import JointCode
from hilplant.bus.mapping import Link

if TYPE_CHECKING:
    from cantools.database.can.signal import Signal as DatabaseSignal

Encode = Callable[[Sequence[float]], tuple[bytes, int]]


def encoder(links: Sequence[Link], codes: Sequence[JointCode], base: bytes) -> Encode:
    """Return a function from all values to a payload and the number of values that had to be limited.

    `links` stand alone, `codes` are signals that are encoded together. `base` is the payload with everything that is
    not mapped; the bits of mapped signals are 0 in it.
    """
    names: dict[str, Any] = {"from_bytes": int.from_bytes}
    signals = [link.database for link in links] + [signal for code in codes for signal in code.signals]
    fields = [f"r{index}" for index in range(len(signals))]
    raws = [_raw(names, f, link) for f, link in zip(fields, links, strict=False)]
    joint = [_joint(names, number, code) for number, code in enumerate(codes)]
    inside = " and ".join([*(_inside(f, link) for f, link in zip(fields, links, strict=False)), "True"])
    names["limited"] = _limited(names, links, raws, codes)
    text = f"""
def encode(values):
    limits = 0
    try:
        {"".join(f"{field}, " for field in fields)} = {"".join(f"{raw}, " for raw in [*raws, *joint])}
        inside = {inside}
    except (ValueError, OverflowError, KeyError):
        inside = False
    if not inside:
        ({"".join(f"{field}, " for field in fields)}), limits = limited(values)
    return {_payload(names, signals, fields, base)}, limits
"""
    exec(compile(text, "<encode>", "exec"), names)
    encode: Encode = names["encode"]
    return encode


def _joint(names: dict[str, Any], number: int, code: JointCode) -> str:
    """Return the expression of the raw values of signals that are encoded together."""
    names[f"joint_{number}"] = code.table
    return f"*joint_{number}[{''.join(f'values[{index}], ' for index in code.indices)}]"


def _raw(names: dict[str, Any], field: str, link: Link) -> str:
    """Return the expression of a raw value; cantools' own order of operations comes last."""
    value = f"values[{link.index}]"
    if link.table is not None:
        names[f"table_{field}"] = _inverted(link.table)
        return f"table_{field}[{value}]"
    if link.offset != 0.0:
        value = f"({value} - {float(link.offset)!r})"
    if link.scale != 1.0:
        value = f"{value} / {float(link.scale)!r}"
    scale, offset = link.database.scale, link.database.offset
    if (scale, offset) != (1, 0):
        value = f"({value} - {offset!r}) / {scale!r}"
    if link.database.is_float:
        return value
    lowest, highest = raw_range(link.database)
    return f"round({value}) % {highest + 1}" if link.plant.wraps and lowest == 0 else f"round({value})"


def _inverted(table: dict[int, float]) -> dict[float, int]:
    """Return the raw value of each choice: the first that is named for it."""
    return {value: raw for raw, value in reversed(table.items())}


def _inside(field: str, link: Link) -> str:
    if link.table is not None:
        return "True"
    lowest, highest = raw_range(link.database)
    return f"{lowest!r} <= {field} <= {highest!r}"


def _limited(
    names: dict[str, Any], links: Sequence[Link], raws: Sequence[str], codes: Sequence[JointCode]
) -> Callable[..., Any]:
    """Return the slow way to all raw values, for the rare case that one of them does not fit."""
    raw_of = [eval(f"lambda values: {raw}", names) for raw in raws]
    limits = [_limit(link) for link in links]

    def limited(values: Sequence[float]) -> tuple[list[float], int]:
        results = [limit(raw, values) for limit, raw in zip(limits, raw_of, strict=True)]
        found, count = [raw for raw, _ in results], sum([count for _, count in results])
        for code in codes:
            wanted = tuple([values[index] for index in code.indices])
            count += wanted not in code.table
            found += code.table.get(wanted) or code.nearest(wanted)
        return found, count

    return limited


def _limit(link: Link) -> Callable[..., tuple[float, int]]:
    lowest, highest = raw_range(link.database)
    raws = _inverted(link.table or {})
    rest = raws[min(raws)] if raws else min(max(lowest, 0), highest)
    counts = int(link.plant.kind != "count")
    rises = link.scale * link.database.scale > 0.0

    def limit(raw: Callable[[Sequence[float]], float], values: Sequence[float]) -> tuple[float, int]:
        value = values[link.index]
        try:
            wanted = raw(values)
        except (ValueError, OverflowError, KeyError):  # not a number, infinite, or not a choice
            if math.isnan(value) or (link.table and link.plant.kind != "real"):
                return rest, counts
            if link.table:  # a number between those that have labels
                return raws[min(raws, key=lambda known: abs(known - value))], counts
            return (highest if (value > 0.0) == rises else lowest), counts
        if link.table or lowest <= wanted <= highest:
            return wanted, 0
        if math.isnan(wanted):
            return rest, counts
        return (highest if wanted > highest else lowest), counts

    return limit


def _payload(names: dict[str, Any], signals: Sequence[DatabaseSignal], fields: Sequence[str], base: bytes) -> str:
    """Return the expression that puts raw values into a payload: one call of struct where it serves."""
    orders = {signal.byte_order for signal in signals}
    pairs = list(zip(signals, fields, strict=True))
    if len(orders) == 1 and not any(base) and all(is_whole_bytes(signal) for signal in signals):
        pairs.sort(key=lambda pair: min(places(pair[0])))
        names["pack"] = struct.Struct(struct_format([signal for signal, _ in pairs], len(base))).pack
        return f"pack({', '.join(field for _, field in pairs)})"
    little = [_placed(names, f, signal, len(base)) for signal, f in pairs if _is_little(signal)]
    big = [_placed(names, f, signal, len(base)) for signal, f in pairs if not _is_little(signal)]
    if not big:
        return f"({_union(little, base, 'little')}).to_bytes({len(base)}, 'little')"
    whole = _union(big, base, "big")
    if little:
        whole += f" | from_bytes(({' | '.join(little)}).to_bytes({len(base)}, 'little'), 'big')"
    return f"({whole}).to_bytes({len(base)}, 'big')"


def _is_little(signal: DatabaseSignal) -> bool:
    return signal.byte_order == "little_endian"


def _union(parts: Sequence[str], base: bytes, order: str) -> str:
    constant = int.from_bytes(base, "little" if order == "little" else "big")
    return " | ".join([*parts, *([str(constant)] if constant else [])])


def _placed(names: dict[str, Any], field: str, signal: DatabaseSignal, length: int) -> str:
    """Return the expression of a raw value's bits at their place in the payload, seen as one whole number."""
    lowest = places(signal)[0]
    shift = lowest if _is_little(signal) else 8 * (length - 1 - lowest // 8) + lowest % 8
    bits = field
    if signal.is_float:
        names[f"pack_{field}"] = struct.Struct(f"<{letter(signal)}").pack
        bits = f"from_bytes(pack_{field}({field}), 'little')"
    elif signal.is_signed:
        bits = f"({field} & {(1 << signal.length) - 1})"
    return f"{bits} << {shift}" if shift else bits
