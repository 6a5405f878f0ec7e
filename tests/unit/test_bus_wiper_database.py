"""The project's own database is complete, sound, and told as it is in the documentation."""

import re
from pathlib import Path

import pytest
from cantools.database.can import Database
from cantools.database.can.message import Message
from cantools.database.can.signal import Signal
from support import signal_table

from hilplant.faults.catalogue import NUMBERS
from hilplant.signals import ACTIVE_MODELS, ECU_FAULTS, ECU_STATES, MODES, RECORDING, SCREENS, STALK_POSITIONS, STATUS

ROOT = Path(__file__).parents[2]
WIPER = Database(strict=True)
WIPER.add_dbc_file(str(ROOT / "dbc" / "wiper.dbc"))
# sent at changes too, so that nothing waits for its cycle
AT_ONCE = ("EcuStatus", "MotorStatus", "ParkSwitch", "PlantStatus", "LossFaults", "FaultStatus")
# the ECU speaks to the plant, and of itself to the driver
DRIVERS = ("StalkCommand", "EcuStatus")
MESSAGES = pytest.mark.parametrize("message", WIPER.messages, ids=lambda message: message.name)


@MESSAGES
def test_every_message_says_who_sends_it_how_often_and_what_it_is(message: Message) -> None:
    (sender,) = message.senders
    ends = {"ECU", "DRIVER"} if message.name in DRIVERS else {"ECU", "PLANT"}
    assert sender in ends
    assert message.receivers == ends - {sender}
    assert message.cycle_time
    assert message.send_type == ("CyclicAndEvent" if message.name in AT_ONCE else "Cyclic")
    assert message.comment
    assert not message.is_fd


@MESSAGES
def test_every_signal_says_what_it_is_and_what_it_can_be(message: Message) -> None:
    for signal in message.signals:
        assert signal.comment
        assert signal.minimum is not None
        assert signal.maximum is not None
        assert signal.byte_order == "little_endian"
        is_factor = signal.name.endswith(("Screen", "Wear", "Force", "RainSignal", "Wetness")) and message.name in {
            "Blades",
            "RainSensor",
        }
        assert signal.unit or signal.choices or is_factor or float(signal.scale) == 1.0
        for physical in (signal.minimum, signal.maximum):
            raw = signal.conversion.numeric_scaled_to_raw(physical)
            lowest = -(1 << signal.length - 1) if signal.is_signed else 0
            assert lowest <= raw < lowest + (1 << signal.length)


def test_value_tables_hold_the_plants_own_names() -> None:
    tables = {
        signal.name: {raw: str(label).lower() for raw, label in signal.choices.items()}
        for message in WIPER.messages
        for signal in message.signals
        if signal.choices
    }
    assert tables["Mode"] == dict(enumerate(MODES))
    assert set(tables["Screen"].values()) == {name for name, _ in SCREENS}
    assert tables["Master_Input"] == dict(enumerate(STALK_POSITIONS))
    assert tables["EcuState"] == dict(enumerate(ECU_STATES))
    assert tables["EcuFault"] == dict(enumerate(ECU_FAULTS))
    assert tables["LoadMode"] == tables["MotorMode"] == dict(enumerate(ACTIVE_MODELS))
    assert tables["Recording"] == dict(enumerate(RECORDING))
    assert tables["FaultShown"] == {0: "none"} | {number: name for name, number in NUMBERS.items()}, (
        "renew it in both databases: python -c 'from hilplant.faults.listing import value_table; print(value_table())'"
    )
    from_plant = {
        "FaultShown",
        "Mode",
        "Screen",
        "RelayOn",
        "RelayFast",
        "ParkContact",
        "Guard",
        "LoadMode",
        "MotorMode",
    }
    assert set(tables) == from_plant | {"FaultShown", "Recording"} | {
        "Master_Input",
        "Flick_Wipe",
        "Wash",
        "Automatic",
        "WasherPump",
        "EcuState",
        "EcuFault",
    }


def test_every_count_of_the_status_has_a_signal() -> None:
    from_plant = [m for m in WIPER.messages if m.senders == ["PLANT"] and m.frame_id >= 0x210]
    outputs = {"Guard", "LoadMode", "MotorMode"}
    counts = [signal for message in from_plant for signal in message.signals if signal.name not in outputs]
    assert len(counts) == len(STATUS)


def test_the_documentations_table_of_frames_is_the_databases() -> None:
    page = (ROOT / "docs" / "can.md").read_text(encoding="utf-8")
    rows = [line for line in page.splitlines() if re.match(r"\| 0x[0-9a-f]+ ", line)]
    assert rows == [row for message in WIPER.messages for row in _rows(message)]


def _rows(message: Message) -> list[str]:
    """Return the rows of a message in the table of the documentation, one for each signal."""
    head = f"| 0x{message.frame_id:x} {message.name} | {message.senders[0]} | {message.cycle_time}"
    head += "+" if message.send_type == "CyclicAndEvent" else ""
    return [f"{head} | {signal.name} | {_bits(signal)} | {_unit(signal)} |" for signal in message.signals]


def _bits(signal: Signal) -> str:
    kind = "i" if signal.is_signed else "u"
    return f"{signal.start}: {kind}{signal.length}"


def _unit(signal: Signal) -> str:
    if signal.name == "FaultShown":
        return "0 none, else the number in [faults.md](faults.md)"
    if signal.choices:
        return ", ".join(f"{raw} {label}" for raw, label in sorted(signal.choices.items()))
    if not signal.unit and float(signal.scale) == 1.0:
        return "count"
    return f"{signal.scale:g} {signal.unit or ''}".strip()


def test_the_documentations_table_of_the_plants_signals_is_the_list() -> None:
    assert signal_table.written() == signal_table.table(), f"docs/can.md is stale: {signal_table.COMMAND}"
