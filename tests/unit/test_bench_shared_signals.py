"""The wiper's stage as cars send it: one enum for both relays, bits for low and high, numbers without labels."""

from pathlib import Path

import pytest

from hilplant.bench import check_bench, load_bench
from hilplant.signals import ECU_TX, ECU_TX_INDEX

DATABASE = """VERSION ""
NS_ :
BS_:
BU_: BCM PLANT
BO_ 640 Stage: 8 BCM
 SG_ WiperStage : 0|3@1+ (1,0) [0|4] "" PLANT
 SG_ WiperLow : 4|1@1+ (1,0) [0|1] "" PLANT
 SG_ WiperHigh : 5|1@1+ (1,0) [0|1] "" PLANT
 SG_ Raw : 6|2@1+ (1,0) [0|3] "" PLANT
 SG_ Volts : 8|16@1+ (0.01,0) [0|40] "V" PLANT
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 100;
VAL_ 640 WiperStage 0 "OFF" 1 "AUTO_LOW" 2 "MAN_LOW" 3 "MAN_HIGH" 4 "AUTO_HIGH" ;
"""
ENUM = """signals:
        WiperStage:
          - {signal: relay_on, choices: {OFF: off, AUTO_LOW: on, MAN_LOW: on, MAN_HIGH: on, AUTO_HIGH: on}}
          - {signal: relay_fast, choices: {OFF: off, AUTO_LOW: off, MAN_LOW: off, MAN_HIGH: on, AUTO_HIGH: on}}"""
NUMBERS = """signals:
        Raw:
          - {signal: relay_on, choices: {0: off, 1: true, 2: 1}}
          - {signal: relay_fast, choices: {0: off, 1: false, 2: on}}"""
BITS = """signals: {WiperHigh: relay_fast}
      conditions: {relay_on: {any: [WiperLow, WiperHigh]}}"""
LABELS = """conditions:
        relay_on: {any: [{WiperStage: [AUTO_LOW, MAN_LOW, 3, AUTO_HIGH]}], all: [{Raw: 1}]}
        relay_fast: {any: [{WiperStage: [MAN_HIGH, 4]}]}"""


def bench(folder: Path, message: str) -> Path:
    (folder / "car.dbc").write_text(DATABASE)
    path = folder / "bench.yaml"
    path.write_text(
        "extends: default.yaml\nname: car\nbus:\n  interface: {interface: virtual, channel: a}\n"
        f"  database: car.dbc\n  send: {{}}\n  receive:\n    Stage:\n      {message}\n"
    )
    return path


@pytest.mark.parametrize(
    ("message", "relays"),
    [
        (ENUM, {0: (0, 0), 1: (1, 0), 2: (1, 0), 3: (1, 1), 4: (1, 1), 5: (-2, -2)}),
        (NUMBERS, {0: (0, 0), 0x40: (1, 0), 0x80: (1, 1), 0xC0: (-2, -2)}),
        (BITS, {0: (0, 0), 0x10: (1, 0), 0x20: (1, 1), 0x30: (1, 1)}),
        (LABELS, {0: (0, 0), 0x40: (0, 0), 0x41: (1, 0), 0x43: (1, 1), 3: (0, 1), 0x45: (0, 0)}),
    ],
)
def test_relays_follow_the_frame_and_the_simulated_ecu_sends_such_frames(
    tmp_path: Path, message: str, relays: dict[int, tuple[int, int]]
) -> None:
    made = load_bench(bench(tmp_path, message))
    (received,) = made.receive
    order = [ECU_TX[target].name for target in received.targets]
    decoded = {first: dict(zip(order, received.decode(bytes([first, *[0] * 7])), strict=True)) for first in relays}
    assert {first: (each["relay_on"], each["relay_fast"]) for first, each in decoded.items()} == relays
    (sent,) = made.ecu_side().send
    for on, fast in ((0, 0), (1, 0), (1, 1)):
        values = [0.0] * len(ECU_TX)
        values[ECU_TX_INDEX["relay_on"]], values[ECU_TX_INDEX["relay_fast"]] = float(on), float(fast)
        payload, limited = sent.encode(values)
        assert limited == 0
        assert relays[payload[0]] == (on, fast)
    assert made.warnings == ()


@pytest.mark.parametrize(
    ("message", "said"),
    [
        ("conditions: {relay_on: {any: [WiperLo]}}", "has no signal 'WiperLo', did you mean 'WiperLow'?"),
        ("conditions: {relay_an: {any: [WiperLow]}}", "the plant has no signal 'relay_an' here, did you mean"),
        ("conditions: {supply_v: {any: [WiperLow]}}", "supply_v is a real, and a condition gives a flag"),
        ("conditions: {relay_on: {}}", "a condition needs any or all: a list of signals"),
        ("conditions: {relay_on: {any: [{WiperStage: MAN}]}}", "no 'MAN'; it has OFF, AUTO_LOW"),
        ("conditions: {relay_on: {any: [{WiperLow: 2}]}}", "it has 1 bits for 0 to 1, so never 2"),
        ("conditions: {relay_on: {any: [{WiperLow: [0, 1]}]}}", "names all of its values"),
        ("signals: {Raw: {signal: relay_on, choices: {0: off, 4: on}}}", "it has 2 bits for 0 to 3, so never 4"),
        ("signals: {Raw: {signal: relay_on, choices: {0: off, low: on}}}", "no 'low'; it has no value table; name the"),
        ("timeout_ms: 0", "key 'signals' is missing"),
        (
            "signals: {WiperLow: relay_on}\n      conditions: {relay_on: {any: [WiperHigh]}}",
            "relay_on is written by two mappings; keep one",
        ),
    ],
)
def test_a_mistake_is_told_at_its_line(tmp_path: Path, message: str, said: str) -> None:
    problems = check_bench(bench(tmp_path, message))
    assert [said in problem.text for problem in problems] == [True], problems
    assert problems[0].line >= (8 if said.startswith("key") else 9)


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (
            "conditions: {relay_on: {any: [WiperLow]}, relay_fast: {any: [WiperLow]}}",
            "no values of WiperLow say relay_on on and relay_fast off, so it cannot be sent",
        ),
        (
            "signals: {Volts: supply_v, WiperHigh: relay_fast}\n      conditions: {relay_on: {any: [Volts]}}",
            "it carries supply_v as a number, so nothing else can be sent in it",
        ),
    ],
)
def test_what_the_simulated_ecu_cannot_send_is_a_warning(tmp_path: Path, message: str, said: str) -> None:
    (warning,) = load_bench(bench(tmp_path, message)).warnings
    assert warning.line == 8
    assert said in warning.text
