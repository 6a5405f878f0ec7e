"""Where the bits of a database's signals lie in a frame, and what they can hold.

A bit's place is 8 * byte + bit, with bit 0 the least significant of its byte; a DBC counts the same way.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cantools.database.can.signal import Signal as DatabaseSignal

_FLOAT_LIMITS = {16: 65504.0, 32: (2.0 - 2.0**-23) * 2.0**127, 64: sys.float_info.max}
_FLOAT_LETTERS = {16: "e", 32: "f", 64: "d"}
_WHOLE_LETTERS = {8: "b", 16: "h", 32: "i", 64: "q"}


def places(signal: DatabaseSignal) -> list[int]:
    """Return the places of a signal's bits, the least significant first."""
    if signal.byte_order == "little_endian":
        return list(range(signal.start, signal.start + signal.length))
    first = []
    place = signal.start  # the most significant bit; after bit 0 of a byte comes bit 7 of the next
    for _ in range(signal.length):
        first.append(place)
        place = place + 15 if place % 8 == 0 else place - 1
    return first[::-1]


def type_range(signal: DatabaseSignal) -> tuple[float, float]:
    """Return the lowest and highest raw value that a signal's bits can hold: whole numbers, or a float's."""
    if signal.is_float:
        limit = _FLOAT_LIMITS[signal.length]
        return -limit, limit
    if signal.is_signed:
        return -(1 << signal.length - 1), (1 << signal.length - 1) - 1
    return 0, (1 << signal.length) - 1


def raw_range(signal: DatabaseSignal) -> tuple[float, float]:
    """Return the lowest and highest raw value that the database permits.

    The range that the database states counts where it says anything: [0|0] is how a DBC says nothing.
    """
    lowest, highest = type_range(signal)
    if signal.minimum is None or signal.maximum is None or signal.minimum >= signal.maximum:
        return lowest, highest
    ends = [(stated - signal.offset) / signal.scale for stated in (signal.minimum, signal.maximum)]
    stated = sorted(ends if signal.is_float else [round(end) for end in ends])
    narrowed = max(lowest, stated[0]), min(highest, stated[1])
    return narrowed if narrowed[0] < narrowed[1] else (lowest, highest)


def letter(signal: DatabaseSignal) -> str | None:
    """Return the letter by which the struct module knows a signal's type; None when it has none."""
    if signal.is_float:
        return _FLOAT_LETTERS.get(signal.length)
    found = _WHOLE_LETTERS.get(signal.length)
    return found if found is None or signal.is_signed else found.upper()


def is_whole_bytes(signal: DatabaseSignal) -> bool:
    """Say whether the struct module can read a signal: one of its types, on the border of a byte."""
    lowest = places(signal)[0]
    return lowest % 8 == 0 and letter(signal) is not None


def struct_format(signals: Sequence[DatabaseSignal], length: int) -> str:
    """Return the struct format of a frame of `length` bytes with these signals, given in order of place."""
    text = ">" if signals and signals[0].byte_order == "big_endian" else "<"
    position = 0
    for signal in signals:
        first = min(places(signal)) // 8
        text += f"{first - position}x{letter(signal)}"
        position = first + signal.length // 8
    return f"{text}{length - position}x"
