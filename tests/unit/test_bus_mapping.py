"""Each mistake in a mapping gets an error that names the signal and says what would be right."""

from collections import OrderedDict
from pathlib import Path

import pytest
from cantools.database.can.message import Message
from cantools.database.can.signal import Signal as DatabaseSignal
from cantools.database.conversion import BaseConversion

from hilplant.bus.codec import MappingError, SignalMapping, Timing, received_message, sent_message
from hilplant.bus.database import load_database
from hilplant.bus.protection import Protection
from hilplant.failure import Failure
from hilplant.signals import INPUTS, PUBLISHED

DATA = Path(__file__).parents[1] / "data" / "bus"
WIPER = load_database(Path(__file__).parents[2] / "dbc" / "wiper.dbc")
PROTECTED = load_database(DATA / "protected.dbc")
UNSOUND = load_database(DATA / "overlapping.dbc")
Map = SignalMapping


def test_a_mapping_error_is_a_failure_that_names_message_and_signal() -> None:
    error = MappingError("Message", "Signal", "text")
    assert isinstance(error, Failure)
    assert (str(error), error.message, error.signal, error.text) == (
        "Message.Signal: text",
        "Message",
        "Signal",
        "text",
    )
    assert str(MappingError("Message", None, "text")) == "Message: text"


@pytest.mark.parametrize(
    ("message", "mappings", "words"),
    [
        ("RelayCommand", [Map("RelayOff", "relay_on")], r"RelayCommand\.RelayOff: .*it has RelayOn, RelayFast"),
        ("RelayCommand", [Map("RelayOn", "relay")], r"RelayOn: the plant has no signal 'relay' here; it has relay_on"),
        ("RelayCommand", [Map("RelayOn", "relay_on", scale=0.0)], "scale must not be 0"),
        (
            "RelayCommand",
            [Map("RelayOn", "relay_on", scale=2.0)],
            "cannot carry 1 of relay_on, which takes all of 0 to 1",
        ),
        ("RelayCommand", [Map("RelayOn", "relay_on", scale=0.5)], "whole numbers must arrive"),
        ("RelayCommand", [Map("RelayOn", "supply_v", invert=True)], "only a flag can be inverted"),
        ("RelayCommand", [Map("RelayOn", "supply_v", choices={"On": "on"})], "supply_v is a real"),
        ("RelayCommand", [Map("RelayOn", "relay_on", choices={"An": "on"})], "no 'An'; it has On, Off"),
        ("RelayCommand", [Map("RelayOn", "relay_on", choices={"On": "closed"})], "no choice 'closed'; it has off"),
        ("RelayCommand", [Map("RelayOn", "relay_on", choices={"On": "on"})], "cannot carry 0 of relay_on"),
        ("RelayCommand", [Map("RelayOn", "relay_on"), Map("RelayFast", "relay_on")], "written by two mappings"),
        ("RelayCommand", [], "no signal is mapped"),
        (
            "Environment",
            [Map("Screen", "screen", choices={"Dry": "moist"})],
            "no choice 'moist'; it has dry, tacky, wet",
        ),
        ("Environment", [Map("Screen", "screen", choices={})], "choices must name at least one label"),
        (
            "Environment",
            [Map("Screen", "screen", offset=1.0, choices={"Dry": "dry"})],
            "choices take no scale and no offset",
        ),
        ("Environment", [Map("Screen", "screen", offset=5.0)], "5 to 7, never within screen's 0 to 1"),
        ("Environment", [Map("VehicleSpeed", "relay_on")], "relay_on is a flag, so whole numbers must arrive"),
        ("SupplyCommand", [Map("SupplyVoltage", "supply_v", offset=1000.0)], "1000 to 1040 V, never within supply_v"),
    ],
)
def test_a_wrong_mapping_of_a_received_message_is_refused(
    message: str, mappings: list[SignalMapping], words: str
) -> None:
    with pytest.raises(MappingError, match=words):
        received_message(WIPER.get_message_by_name(message), mappings, INPUTS)


@pytest.mark.parametrize(
    ("message", "mappings", "timing", "words"),
    [
        ("ParkSwitch", [Map("ParkContact", "mode")], Timing(), "which of Closed, Open stands for waiting"),
        (
            "ParkSwitch",
            [Map("ParkContact", "guard"), Map("ParkContact", "park_contact")],
            Timing(),
            "no values of ParkContact say guard off and park_contact on, so it cannot be sent",
        ),
        ("ParkSwitch", [Map("ParkContact", "park_contact")], Timing(on_change=("park",)), "on_change names 'park'"),
    ],
)
def test_a_wrong_mapping_of_a_sent_message_is_refused(
    message: str, mappings: list[SignalMapping], timing: Timing, words: str
) -> None:
    with pytest.raises(MappingError, match=words):
        sent_message(WIPER.get_message_by_name(message), mappings, PUBLISHED, timing)


def test_a_message_without_cycle_time_needs_a_period() -> None:
    with pytest.raises(MappingError, match="no cycle time"):
        sent_message(UNSOUND.get_message_by_name("Initial"), [Map("Free", "current_a")], PUBLISHED)


def test_multiplexed_signals_cannot_be_sent() -> None:
    with pytest.raises(MappingError, match=r"Pages\.Supply: multiplexed signals can be received only"):
        sent_message(UNSOUND.get_message_by_name("Pages"), [Map("Supply", "supply_v")], PUBLISHED, Timing(0))


def test_a_signal_beyond_the_end_of_its_frame_is_refused() -> None:
    with pytest.raises(MappingError, match=r"Unsound\.Beyond: it does not fit in the frame's 2 bytes"):
        received_message(UNSOUND.get_message_by_name("Unsound"), [Map("Beyond", "supply_v")], INPUTS)


def test_a_signal_under_the_protections_header_is_refused_and_beside_it_is_not() -> None:
    message = PROTECTED.get_message_by_name("RelayProfile1")
    flag = [Map("RelayOn", "relay_on")]
    received_message(message, flag, INPUTS, protection=Protection(1, message.length, data_id=1))
    nibble = Protection(1, message.length, data_id=1, data_id_mode="nibble")
    with pytest.raises(
        MappingError, match=r"RelayProfile1\.RelayOn: it lies where protection profile 1 has its header"
    ):
        received_message(message, flag, INPUTS, protection=nibble)


@pytest.mark.parametrize(
    ("places", "offset", "words"),
    [
        ([(0, 12), (8, 8)], None, r"M\.B: it shares bits with A"),
        ([(0, 12), (60, 8)], None, r"M\.B: it does not fit in the frame's 8 bytes"),
        ([(40, 8), (20, 8)], 0, r"M\.B: it lies where protection profile 5"),
        ([(0, 8), (24, 8)], 3, r"M\.B: it lies where protection profile 5"),
    ],
)
def test_a_signal_that_cannot_be_sent_beside_what_the_frame_carries_is_refused(
    places: list[tuple[int, int]], offset: int | None, words: str
) -> None:
    signals = [DatabaseSignal(name, start, length) for name, (start, length) in zip("AB", places, strict=True)]
    message = Message(1, "M", 8, signals, strict=False)
    protection = None if offset is None else Protection(5, 8, data_id=1, offset=offset)
    maps = [Map("A", "current_a"), Map("B", "terminal_v")]
    with pytest.raises(MappingError, match=words):
        sent_message(message, maps, PUBLISHED, Timing(0), protection)
    assert sent_message(message, maps[:1], PUBLISHED, Timing(0), protection).protection == protection


@pytest.mark.parametrize(
    ("length", "is_fd", "words"), [(12, False, "12 bytes need an FD frame"), (13, True, "no FD frame has 13 bytes")]
)
def test_a_length_that_no_frame_has_is_refused(length: int, is_fd: bool, words: str) -> None:
    message = Message(1, "Long", length, [DatabaseSignal("Voltage", 0, 8)], is_fd=is_fd)
    with pytest.raises(MappingError, match=words):
        received_message(message, [Map("Voltage", "supply_v")], INPUTS)


def test_a_float_cannot_carry_choices() -> None:
    conversion = BaseConversion.factory(1, 0, OrderedDict({0: "Dry", 1: "Wet"}), True)
    message = Message(1, "Odd", 4, [DatabaseSignal("Screen", 0, 32, conversion=conversion)])
    with pytest.raises(MappingError, match="a float cannot carry choices"):
        received_message(message, [Map("Screen", "screen", choices={"Dry": "dry"})], INPUTS)
