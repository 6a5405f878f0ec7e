"""Generated encoders and decoders against cantools, on random frames of random databases."""

import math
from itertools import pairwise
from typing import Any, get_args

from cantools.database.can.message import Message
from cantools.database.can.signal import Signal as DatabaseSignal
from cantools.database.conversion import BaseConversion
from cantools.typechecking import ByteOrder
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from hilplant.bus.bits import type_range
from hilplant.bus.codec import SignalMapping, Timing, received_message, sent_message
from hilplant.declaration import Signal

SCALES = st.sampled_from([1, 1.0, 0.5, 0.1, 0.001, 2, 3, -1, -0.1, 0.25, 1e-4])
OFFSETS = st.sampled_from([0, 0.0, -40, 0.5, 100, -273.15])
ORDERS: tuple[ByteOrder, ...] = get_args(ByteOrder)
LENGTHS = st.sampled_from([*range(1, 9), 12, 16, 20, 24, 32, 48, 64])


@st.composite
def database_signals(draw: st.DrawFn, first: int, last: int, order: ByteOrder, name: str) -> DatabaseSignal:
    """Draw a signal on the bits from first to last, counted in the direction of its byte order."""
    length = last - first
    is_float = length in (16, 32, 64) and draw(st.booleans())
    start = first if order == "little_endian" else 8 * (first // 8) + 7 - first % 8
    conversion = BaseConversion.factory(draw(SCALES), draw(OFFSETS), None, is_float)
    return DatabaseSignal(name, start, length, order, draw(st.booleans()), conversion=conversion)


@st.composite
def messages(draw: st.DrawFn) -> Message:
    """Draw a message: areas of whole bytes in either byte order, each cut into signals and gaps."""
    length = draw(LENGTHS)
    borders = sorted({0, length, *draw(st.lists(st.integers(0, length), max_size=3))})
    signals: list[DatabaseSignal] = []
    for low, high in pairwise(borders):
        order = draw(st.sampled_from(ORDERS))
        whole = draw(st.booleans())
        steps = st.integers(low, high).map(lambda byte: 8 * byte) if whole else st.integers(8 * low, 8 * high)
        for first, last in pairwise(sorted(set(draw(st.lists(steps, min_size=2, max_size=5))))):
            if last - first <= 64 and draw(st.integers(0, 4)):
                signals.append(draw(database_signals(first, last, order, f"S{len(signals)}")))
    assume(signals)
    return Message(0x123, "M", length, signals, is_fd=length > 8, strict=True)


def physical(signal: DatabaseSignal, raw: float) -> float:
    value = signal.conversion.raw_to_scaled(raw, decode_choices=False)
    assert isinstance(value, int | float)
    return float(value)


def plant_signals(message: Message) -> tuple[Signal, ...]:
    return tuple(Signal(s.name, "", -math.inf, math.inf, "drawn") for s in message.signals)


def mappings(message: Message) -> list[SignalMapping]:
    return [SignalMapping(signal.name, signal.name) for signal in message.signals]


@settings(deadline=None, max_examples=300)
@given(st.data())
def test_decoding_equals_cantools(data: st.DataObject) -> None:
    message = data.draw(messages())
    received = received_message(message, mappings(message), plant_signals(message))
    payload = data.draw(st.binary(min_size=message.length, max_size=message.length))
    expected: dict[str, Any] = message.decode_simple(payload, decode_choices=False)
    decoded = dict(zip((s.name for s in message.signals), received.decode(payload), strict=True))
    for name, value in decoded.items():
        assert isinstance(value, float)
        assert value == float(expected[name]) or (math.isnan(value) and math.isnan(expected[name]))


@settings(deadline=None, max_examples=300)
@given(st.data())
def test_encoding_equals_cantools_for_values_within_range(data: st.DataObject) -> None:
    message = data.draw(messages())
    sent = sent_message(message, mappings(message), plant_signals(message), Timing(period_ns=0))
    values = [data.draw(physical_values(signal)) for signal in message.signals]
    expected = message.encode(
        {s.name: v for s, v in zip(message.signals, values, strict=True)}, strict=False, padding=False
    )
    assert sent.encode(values) == (expected, 0)


@st.composite
def physical_values(draw: st.DrawFn, signal: DatabaseSignal) -> float:
    """Draw a physical value that the signal can carry, on the grid of its raw values or beside it."""
    lowest, highest = type_range(signal)
    if signal.is_float:
        value = physical(signal, draw(st.floats(-1000.0, 1000.0)))
    else:
        raw = draw(st.integers(int(lowest), int(highest)))
        value = physical(signal, raw + draw(st.sampled_from([0.0, 0.25, -0.4, 0.5])))
    assume(lowest <= signal.conversion.numeric_scaled_to_raw(value) <= highest)
    return value


@settings(deadline=None, max_examples=200)
@given(st.data())
def test_encoding_takes_any_number_and_says_how_many_it_limited(data: st.DataObject) -> None:
    message = data.draw(messages())
    sent = sent_message(message, mappings(message), plant_signals(message), Timing(period_ns=0))
    received = received_message(message, mappings(message), plant_signals(message))
    values = [data.draw(st.floats()) for _ in message.signals]
    payload, limited = sent.encode(values)
    assert len(payload) == message.length
    decoded = received.decode(payload)
    assert all(value is not None and math.isfinite(value) for value in decoded)
    for signal, value, back in zip(message.signals, values, decoded, strict=True):
        assert back is not None
        step = abs(signal.scale)
        if math.isinf(value) and not signal.is_float:
            ends = [physical(signal, raw) for raw in type_range(signal)]
            assert back == (max(ends) if value > 0 else min(ends))
            limited -= 1
        elif not math.isfinite(value) or (not signal.is_float and abs(back - value) > step + 1e-9 * abs(value)):
            limited -= 1
    assert limited >= 0
