"""One enum for both relays, and bits joined by conditions: against every payload that there is, both ways."""

from itertools import product
from typing import Any

import pytest
from cantools.database.can.message import Message
from cantools.database.can.signal import Signal as DatabaseSignal
from cantools.database.conversion import BaseConversion
from hypothesis import given, settings
from hypothesis import strategies as st

from hilplant.bus.codec import (
    FlagCondition,
    Mapped,
    MappingError,
    SignalMapping,
    Timing,
    received_message,
    sent_message,
)
from hilplant.bus.flag_conditions import ConditionTerm
from hilplant.signals import INPUT_INDEX, INPUTS

ON, FAST = INPUT_INDEX["relay_on"], INPUT_INDEX["relay_fast"]
NEEDED = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]  # fast means nothing while the motor is off


def drawn_signal(name: str, start: int, length: int, labels: dict[int, str]) -> DatabaseSignal:
    conversion = BaseConversion.factory(1, 0, labels or None, False)
    return DatabaseSignal(name, start, length, "little_endian", False, conversion=conversion)


@st.composite
def enums(draw: st.DrawFn) -> tuple[Message, dict[int, tuple[str, str]]]:
    """Draw an enum of two to four bits, some raw values with labels, and what each known one means for the relays."""
    length = draw(st.integers(2, 4))
    raws = st.sampled_from(range(2**length))
    meanings = draw(st.dictionaries(raws, st.tuples(*[st.sampled_from(["off", "on"])] * 2), min_size=1))
    labels = {raw: f"STAGE_{raw}" for raw in draw(st.sets(raws))}
    signal = drawn_signal("Stage", draw(st.integers(0, 12)), length, labels)
    return Message(0x100, "M", 2, [signal], strict=True), meanings


@settings(deadline=None, max_examples=200)
@given(enums(), st.binary(min_size=2, max_size=2))
def test_an_enum_of_both_relays_is_read_and_written(drawn: tuple[Message, dict[int, Any]], payload: bytes) -> None:
    message, meanings = drawn
    labels = message.signals[0].choices or {}
    named = {raw: str(labels.get(raw, raw)) for raw in meanings}
    mappings = [
        SignalMapping("Stage", plant, choices={named[raw]: both[index] for raw, both in meanings.items()})
        for index, plant in enumerate(("relay_on", "relay_fast"))
    ]
    said = {tuple(float(word == "on") for word in both): raw for raw, both in meanings.items()}
    if {on for on, _ in said} != {0.0, 1.0} or {fast for _, fast in said} != {0.0, 1.0}:
        with pytest.raises(MappingError, match="cannot carry"):
            received_message(message, mappings, INPUTS)
        return
    received = received_message(message, mappings, INPUTS)
    raw: Any = message.decode(payload, decode_choices=False)
    expected = [float(word == "on") for word in meanings.get(raw["Stage"], ())] or [-2.0, -2.0]
    assert list(received.decode(payload)) == expected
    check_sending(message, mappings, set(said))


TERMS = st.tuples(st.sampled_from(["A", "B", "C"]), st.none() | st.sets(st.integers(0, 3), min_size=1, max_size=3))


@settings(deadline=None, max_examples=200)
@given(st.lists(TERMS, max_size=3), st.lists(TERMS, max_size=2), st.booleans())
def test_conditions_are_read_and_written(some: list[Any], every: list[Any], shares: bool) -> None:
    message = Message(0x100, "M", 1, [drawn_signal(name, 2 * n, 2, {}) for n, name in enumerate("ABCD")], strict=True)
    fast: Mapped = (
        FlagCondition("relay_fast", (ConditionTerm("A", ("3",)),))
        if shares
        else SignalMapping("D", "relay_fast", choices={"0": "off", "1": "on"})
    )
    if not some and not every:
        return
    condition = FlagCondition("relay_on", tuple(map(term, some)), tuple(map(term, every)))
    received = received_message(message, [condition, fast], INPUTS)
    said = set()
    for raw in range(256):
        signals: Any = message.decode(bytes([raw]), decode_choices=False)
        on = (any(holds(each, signals) for each in some) or not some) and all(holds(each, signals) for each in every)
        is_fast = float(signals["A"] == 3) if shares else {0: 0.0, 1: 1.0}.get(signals["D"], -2.0)
        assert received.decode(bytes([raw])) == (float(on), is_fast)
        said |= {(float(on), is_fast)} if is_fast >= 0 else set()
    check_sending(message, [condition, fast], said)


def term(drawn: Any) -> ConditionTerm:
    name, values = drawn
    return ConditionTerm(name, tuple(map(str, values or ())))


def holds(drawn: Any, signals: dict[str, int]) -> bool:
    name, values = drawn
    return signals[name] in values if values else signals[name] != 0


def check_sending(message: Message, mappings: list[Mapped], said: set[Any]) -> None:
    """Check that what can be said is written so that it is read back, and that else the message is refused."""
    if not said.issuperset(NEEDED):
        with pytest.raises(MappingError, match="so it cannot be sent"):
            sent_message(message, mappings, INPUTS, Timing(0))
        return
    sent = sent_message(message, mappings, INPUTS, Timing(0))
    received = received_message(message, mappings, INPUTS)
    for on, fast in product((0.0, 1.0), repeat=2):
        values = [0.0] * len(INPUTS)
        values[ON], values[FAST] = on, fast
        payload, limited = sent.encode(values)
        back = received.decode(payload)
        assert (back == (on, fast), limited) in [(True, 0), (False, 1)]
        assert back[0] == on  # what cannot be said at least does not switch the motor
        assert limited == int((on, fast) not in said)
