"""A J1939 message is its parameter group: on the bus and in logs alike, whoever sends it."""

from pathlib import Path
from typing import Any

import can
import pytest

from hilplant.bench import load_bench
from hilplant.bench.assembly import Bench
from hilplant.bus.frame import Frame
from hilplant.bus.j1939 import destination, parameter_group
from hilplant.bus.link import LinkSettings
from hilplant.bus.node import Node
from hilplant.failure import Failure
from hilplant.measurements.files import Origin, read_channels
from hilplant.measurements.frames import FrameSource
from hilplant.signals import INPUT_INDEX, INPUTS, STATUS_INDEX

KIND = 'BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG";\n'
BENCH = """extends: virtual.yaml
name: x
bus:
  interface: {{interface: virtual, channel: a}}
  database: x.dbc
  timeout_ms: 0
  receive: {{{0}}}
  send: {{}}
"""
#: A message and the signal it sets.
INPUT_OF = {"Volts": "supply_v", "Speed": "vehicle_speed_m_s"}


def bench(folder: Path, identifiers: dict[str, int], kind: int = 3) -> Bench:
    messages = "".join(
        f'BO_ {number | 1 << 31} {name}: 8 Vector__XXX\n SG_ Value : 0|8@1+ (0.1,0) [0|0] "" Vector__XXX\n'
        for name, number in identifiers.items()
    )
    values = "".join(f'BA_ "VFrameFormat" BO_ {number | 1 << 31} {kind};\n' for number in identifiers.values())
    (folder / "x.dbc").write_text(f'VERSION ""\nBU_: A\n{messages}\n{KIND}{values}')
    lines = ", ".join(f"{name}: {{signals: {{Value: {INPUT_OF[name]}}}}}" for name in identifiers)
    (folder / "bench.yaml").write_text(BENCH.format(lines))
    return load_bench(folder / "bench.yaml")


class Bus:
    up, missed = True, 0

    def __init__(self, *identifiers: int) -> None:
        self.frames = [Frame(number, bytes([120, *bytes(7)]), number > 0x7FF, False) for number in identifiers]

    def receive_late(self, limit: int) -> list[Any]:
        return [(self.frames.pop(), None)] if self.frames else []

    receive = receive_late


def taken(made: Bench, identifier: int) -> dict[str, float]:
    """Return which inputs one frame sets; a frame that sets none is counted as unknown."""
    values = [-1.0] * len(INPUTS)
    node = Node(made.receive, (), Bus(identifier), LinkSettings(), values)  # type: ignore[arg-type]
    node.receive(0)
    found = {name: values[INPUT_INDEX[name]] for name in INPUT_OF.values() if values[INPUT_INDEX[name]] != -1.0}
    assert node.counts[STATUS_INDEX["unknown_frame"]] == (not found)
    return found


@pytest.mark.parametrize(("stated", "frame", "is_it"), [
    (0x18FEF1FE, 0x18FEF1FE, True), (0x18FEF1FE, 0x18FEF100, True), (0x18FEF1FE, 0x0CFEF147, True),
    (0x18FEF1FE, 0x18FEF2FE, False), (0x18FEF1FE, 0x19FEF1FE, False), (0x18FEF1FE, 0xF1, False),
    (0x18F000FE, 0x18F00033, True), (0x18F000FE, 0x18F0FF33, False),
    (0x18EF2100, 0x18EF2147, True), (0x18EF2100, 0x18EF2247, False), (0x18EF2100, 0x18EFFF47, True),
    (0x18EFFE00, 0x18EF2247, True), (0x18EFFF00, 0x0CEF2247, True), (0x18EFFF00, 0x0CEE2247, False),
])  # fmt: skip
def test_a_frame_of_any_sender_is_the_message_of_its_group(
    tmp_path: Path, stated: int, frame: int, is_it: bool
) -> None:
    assert taken(bench(tmp_path, {"Volts": stated}), frame) == ({"supply_v": pytest.approx(12.0)} if is_it else {})


def test_other_messages_are_known_by_their_identifier_alone(tmp_path: Path) -> None:
    made = bench(tmp_path, {"Volts": 0x18FEF1FE}, kind=1)
    assert taken(made, 0x18FEF1FE)
    assert not taken(made, 0x18FEF100)


def test_two_messages_of_one_group_are_known_by_their_senders(tmp_path: Path) -> None:
    made = bench(tmp_path, {"Volts": 0x18FEF100, "Speed": 0x18FEF147})
    assert list(taken(made, 0x18FEF100)) == ["supply_v"]
    assert list(taken(made, 0x18FEF147)) == ["vehicle_speed_m_s"]
    assert not taken(made, 0x18FEF133)


def test_group_and_destination() -> None:
    """Table 2 of J1939-21: PDU 1 below format 240 has a destination, PDU 2 a group extension."""
    assert [hex(parameter_group(n)) for n in (0x18EF2147, 0x18F00147, 0x1DEF2147)] == ["0xef00", "0xf001", "0x1ef00"]
    assert [destination(n) for n in (0x18EF2147, 0x18F02147)] == [0x21, 255]


def test_a_log_read_through_the_bench(tmp_path: Path) -> None:
    bench(tmp_path, {"Volts": 0x18FEF1FE})
    for count, name in ((1, "one.blf"), (2, "two.blf")):
        with can.Logger(tmp_path / name) as log:
            for sender in range(count):
                log(can.Message(sender * 0.1, 0x18FEF100 + sender, data=bytes([120, *bytes(7)])))
    source = FrameSource(bench=str(tmp_path / "bench.yaml"))
    channels = read_channels(Origin(tmp_path / "one.blf", frames=source))
    assert channels["supply_v"].values.tolist() == [pytest.approx(12.0)]
    with pytest.raises(Failure, match="Volts comes from two senders, 0x18FEF100 and 0x18FEF101"):
        read_channels(Origin(tmp_path / "two.blf", frames=source))
