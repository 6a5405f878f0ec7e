"""Messages of the project's database and of unsound ones, in both directions."""

import math
from collections import OrderedDict
from pathlib import Path
from typing import Any

import pytest
from cantools.database.can.message import Message
from cantools.database.can.signal import Signal as DatabaseSignal
from cantools.database.conversion import BaseConversion

from hilplant.bus.codec import (
    MappingError,
    ReceivedMessage,
    SentMessage,
    SignalMapping,
    Timing,
    received_message,
    sent_message,
)
from hilplant.bus.database import load_database
from hilplant.signals import INPUT_INDEX, INPUTS, PUBLISHED, PUBLISHED_INDEX

WIPER = load_database(Path(__file__).parents[2] / "dbc" / "wiper.dbc")
UNSOUND = load_database(Path(__file__).parents[1] / "data" / "bus" / "overlapping.dbc")

RELAYS = [SignalMapping("RelayOn", "relay_on"), SignalMapping("RelayFast", "relay_fast")]
MOTOR = [
    SignalMapping("MotorCurrent", "current_a"),
    SignalMapping("MotorSpeed", "motor_speed_rad_s"),
    SignalMapping("TerminalVoltage", "terminal_v"),
]


def received(name: str, *mappings: SignalMapping) -> ReceivedMessage:
    return received_message(WIPER.get_message_by_name(name), mappings, INPUTS)


def sent(name: str, *mappings: SignalMapping) -> SentMessage:
    return sent_message(WIPER.get_message_by_name(name), mappings, PUBLISHED)


def published(**values: float) -> list[float]:
    """Return all published values, 0 where nothing is said."""
    row = [0.0] * len(PUBLISHED)
    for name, value in values.items():
        row[PUBLISHED_INDEX[name]] = value
    return row


def decoded_by_cantools(name: str, payload: bytes) -> dict[str, Any]:
    return WIPER.get_message_by_name(name).decode_simple(payload)


@pytest.mark.parametrize(
    ("payload", "relays"), [("0000", (0.0, 0.0)), ("0100", (1.0, 0.0)), ("0300", (1.0, 1.0)), ("fcff", (0.0, 0.0))]
)
def test_the_relay_command_of_the_readme_means_what_it_says(payload: str, relays: tuple[float, float]) -> None:
    message = received("RelayCommand", *RELAYS)
    assert (message.identifier, message.extended, message.fd, message.length) == (0x120, False, False, 2)
    assert message.targets == (INPUT_INDEX["relay_on"], INPUT_INDEX["relay_fast"])
    assert message.decode(bytes.fromhex(payload)) == relays


def test_choices_with_equal_names_need_no_mapping_and_others_get_one() -> None:
    by_name = received("Environment", SignalMapping("Screen", "screen"))
    swapped = received("Environment", SignalMapping("Screen", "screen", choices={"Dry": "wet", "Wet": "dry"}))
    assert [by_name.decode(bytes([raw, 0, 0])) for raw in (0, 1, 2)] == [(0.0,), (1.0,), (0.5,)]
    assert [swapped.decode(bytes([raw, 0, 0])) for raw in (0, 1)] == [(1.0,), (0.0,)]


def test_a_raw_value_without_a_choice_is_out_of_range_not_an_error() -> None:
    message = received("Environment", SignalMapping("Screen", "screen"))
    ((lowest, _),) = message.limits
    (value,) = message.decode(bytes([3, 0, 0]))
    assert value is not None
    assert value < lowest


def test_a_number_with_names_is_taken_by_its_value_where_it_is_scaled_or_the_labels_agree() -> None:
    """Raw 1 of a wetness in halves is tacky, though the same raw 1 is labelled Wet."""
    halves = received("Environment", SignalMapping("Screen", "screen", scale=0.5))
    assert [halves.decode(bytes([raw, 0, 0])) for raw in (0, 1, 2)] == [(0.0,), (0.5,), (1.0,)]
    percent = BaseConversion.factory(0.01, 0, OrderedDict({0: "Dry", 50: "Tacky", 100: "Wet"}), False)
    message = Message(1, "Rain", 1, [DatabaseSignal("Wetness", 0, 8, conversion=percent)])
    agreeing = received_message(message, [SignalMapping("Wetness", "screen")], INPUTS)
    assert [agreeing.decode(bytes([raw])) for raw in (0, 30, 100)] == [(0.0,), (0.3,), (1.0,)]


def test_a_label_may_say_same_and_a_raw_value_without_a_label_does_not() -> None:
    conversion = BaseConversion.factory(1, 0, OrderedDict({0: "Off", 1: "Wet"}), False)
    message = Message(1, "Side", 1, [DatabaseSignal("Left", 0, 8, conversion=conversion)])
    mapping = SignalMapping("Left", "left_screen", choices={"Off": "same", "Wet": "wet"})
    made = received_message(message, [mapping], INPUTS)
    ((lowest, _),) = made.limits
    assert [made.decode(bytes([raw])) for raw in (0, 1)] == [(-1.0,), (1.0,)]
    (value,) = made.decode(bytes([7]))
    assert value is not None and value < lowest


@pytest.mark.parametrize(("value", "raw", "limited"), [(0.5, 2, 0), (1.0, 1, 0), (0.1, 0, 1), (0.9, 1, 1)])
def test_a_number_without_a_label_is_sent_as_the_nearest_that_has_one(value: float, raw: int, limited: int) -> None:
    message = sent_message(WIPER.get_message_by_name("Environment"), [SignalMapping("Screen", "screen")], INPUTS)
    inputs = [0.0] * len(INPUTS)
    inputs[INPUT_INDEX["screen"]] = value
    assert message.encode(inputs) == (bytes([raw, 0, 0]), limited)


def test_scale_and_offset_lead_to_the_plants_unit() -> None:
    kilometres_per_hour = SignalMapping("VehicleSpeed", "vehicle_speed_m_s", scale=1 / 3.6, offset=-2.0)
    (value,) = received("Environment", kilometres_per_hour).decode(bytes.fromhex("00102700"[:6]))
    assert value == pytest.approx(100.0 / 3.6 - 2.0, rel=1e-15)


def test_an_inverted_flag_is_the_other_one_in_both_directions() -> None:
    mapping = SignalMapping("RelayOn", "relay_on", invert=True)
    incoming = received("RelayCommand", mapping)
    outgoing = sent_message(WIPER.get_message_by_name("RelayCommand"), [mapping], INPUTS)
    commands = [0.0] * len(INPUTS)
    assert incoming.decode(b"\x00\x00") == (1.0,)
    assert outgoing.encode(commands) == (b"\x01\x00", 0)


def test_what_the_plant_sends_the_ecu_reads_with_the_same_mapping() -> None:
    message = WIPER.get_message_by_name("MotorStatus")
    values = published(current_a=-12.34, motor_speed_rad_s=56.7, terminal_v=13.5)
    payload, limited = sent("MotorStatus", *MOTOR).encode(values)
    assert limited == 0
    assert received_message(message, MOTOR, PUBLISHED).decode(payload) == pytest.approx((-12.34, 56.7, 13.5))


def test_values_beyond_the_frame_are_limited_and_counted() -> None:
    values = published(current_a=1e9, motor_speed_rad_s=math.nan, terminal_v=-math.inf)
    payload, limited = sent("MotorStatus", *MOTOR).encode(values)
    assert limited == 3
    decoded = decoded_by_cantools("MotorStatus", payload)
    assert decoded["MotorCurrent"] == pytest.approx(327.67)
    assert (decoded["MotorSpeed"], decoded["TerminalVoltage"]) == (0, -40.0)


def test_one_value_beyond_the_frame_leaves_the_others_as_they_are() -> None:
    payload, limited = sent("MotorStatus", *MOTOR).encode(published(current_a=-1e9, terminal_v=12.0))
    decoded = decoded_by_cantools("MotorStatus", payload)
    assert (decoded["MotorCurrent"], decoded["TerminalVoltage"], limited) == (-327.68, 12.0, 1)


def test_the_databases_range_limits_where_it_is_narrower_than_the_bits() -> None:
    payload, limited = sent("MotorStatus", *MOTOR).encode(published(terminal_v=45.0))
    assert (decoded_by_cantools("MotorStatus", payload)["TerminalVoltage"], limited) == (40.0, 1)


def test_a_count_stays_at_its_highest_value_in_silence() -> None:
    message = sent("PlantStatus", SignalMapping("Overruns", "overruns"), SignalMapping("Mode", "mode"))
    payload, limited = message.encode(published(overruns=123456.0, mode=3.0))
    decoded = decoded_by_cantools("PlantStatus", payload)
    assert (decoded["Overruns"], str(decoded["Mode"]), limited) == (4095, "Degraded", 0)


def test_a_choice_that_does_not_exist_is_limited_and_counted() -> None:
    message = sent("PlantStatus", SignalMapping("Mode", "mode"))
    for wrong in (17.0, 0.5, math.nan):
        payload, limited = message.encode(published(mode=wrong))
        assert (str(decoded_by_cantools("PlantStatus", payload)["Mode"]), limited) == ("Waiting", 1)


def test_a_value_at_the_end_of_its_range_survives_the_rounding_of_the_bus() -> None:
    mapping = SignalMapping("CrankAngle", "crank_angle_rad")
    message = WIPER.get_message_by_name("Linkage")
    payload, limited = sent("Linkage", mapping).encode(published(crank_angle_rad=6.28318))
    incoming = received_message(message, [mapping], PUBLISHED)
    (value,), ((lowest, highest),) = incoming.decode(payload), incoming.limits
    assert limited == 0
    assert value is not None
    assert lowest <= value <= highest


@pytest.mark.parametrize(
    ("factor", "is_float", "mapping", "limits"),
    [
        (0.5, False, SignalMapping("Voltage", "supply_v"), (9.75, 30.25)),
        (-0.5, False, SignalMapping("Voltage", "supply_v"), (9.75, 30.25)),
        (0.5, False, SignalMapping("Voltage", "supply_v", scale=0.1), (1.0 - 0.025, 3.0 + 0.025)),
        (0.5, False, SignalMapping("Voltage", "supply_v", scale=-0.1, offset=5.0), (2.0 - 0.025, 4.0 + 0.025)),
        (0.5, False, SignalMapping("Voltage", "supply_v", scale=4.0), (40.0 - 1.0, 100.0 + 1.0)),
        (0.5, True, SignalMapping("Voltage", "supply_v"), (10.0, 30.0)),
        (0.5, True, SignalMapping("Voltage", "supply_v", scale=0.1), (1.0, 3.0)),
    ],
)
def test_limits_are_the_narrower_range_and_half_a_raw_step_wider(
    factor: float, is_float: bool, mapping: SignalMapping, limits: tuple[float, float]
) -> None:
    """The database permits 10 to 30, the plant -16 to 100 V; a float is not rounded on its way."""
    conversion = BaseConversion.factory(factor, 0, None, is_float)
    bits = 32 if is_float else 16
    voltage = DatabaseSignal("Voltage", 0, bits, is_signed=True, conversion=conversion, minimum=10, maximum=30)
    assert received_message(Message(1, "One", 8, [voltage]), [mapping], INPUTS).limits == (pytest.approx(limits),)


def test_timing_comes_from_the_database_unless_it_is_given() -> None:
    message = WIPER.get_message_by_name("ParkSwitch")
    mapping = [SignalMapping("ParkContact", "park_contact")]
    own = sent_message(message, mapping, PUBLISHED)
    timing = Timing(period_ns=0, offset_ns=7, on_change=("park_contact",))
    given = sent_message(message, mapping, PUBLISHED, timing)
    park = PUBLISHED_INDEX["park_contact"]
    assert (own.period_ns, own.offset_ns, own.on_change) == (20_000_000, 0, ())
    assert (given.period_ns, given.offset_ns, given.on_change, given.sources) == (0, 7, (park,), (park,))


def test_multiplexed_signals_are_none_on_another_page() -> None:
    mappings = [
        SignalMapping("Supply", "supply_v"),
        SignalMapping("Speed", "vehicle_speed_m_s"),
        SignalMapping("Wetness", "screen"),
    ]
    message = received_message(UNSOUND.get_message_by_name("Pages"), mappings, INPUTS)
    assert list(message.decode(bytes.fromhex("0146050000000000"))) == [pytest.approx(13.5), None, None]
    assert list(message.decode(bytes.fromhex("02f6ff0100000000"))) == [None, pytest.approx(-1.0), 1.0]
    assert message.decode(bytes.fromhex("0f00000000000000")) == (None, None, None)


def test_signals_that_overlap_do_not_matter_unless_both_are_mapped() -> None:
    message = UNSOUND.get_message_by_name("Unsound")
    first, second = SignalMapping("First", "supply_v"), SignalMapping("Second", "vehicle_speed_m_s")
    assert received_message(message, [second], INPUTS).decode(b"\x00\x2a") == (42.0,)
    with pytest.raises(MappingError, match=r"Unsound\.Second: it shares bits with First"):
        received_message(message, [first, second], INPUTS)


def test_what_is_not_mapped_is_sent_at_its_initial_value() -> None:
    message = UNSOUND.get_message_by_name("Initial")
    sent_one = sent_message(message, [SignalMapping("Free", "current_a")], PUBLISHED, Timing(period_ns=0))
    payload, _ = sent_one.encode(published(current_a=1.0))
    assert payload.hex() == "5affe000010f0000"  # 90, -2 in Motorola order, 1, and what is left of a covered signal
