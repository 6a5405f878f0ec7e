"""What was out of range is remembered with its message, input and value."""

from pathlib import Path
from typing import Any

import pytest

from hilplant.bench import check_bench, load_bench
from hilplant.bus.frame import Frame
from hilplant.bus.link import LinkSettings
from hilplant.bus.node import Node
from hilplant.signals import INPUT_INDEX, INPUTS, STATUS_INDEX

DATABASE = """VERSION ""
BU_: ECU PLANT
BO_ 288 Cmd: 4 ECU
 SG_ On : 0|2@1+ (1,0) [0|3] "" PLANT
 SG_ Volts : 8|16@1+ (0.01,0) [0|0] "V" PLANT
"""
BENCH = """extends: virtual.yaml
name: x
bus:
  interface: {interface: virtual, channel: a}
  database: x.dbc
  TIMEOUT
  receive: {Cmd: {signals: {On: {signal: relay_on, choices: {0: off, 1: on}}, Volts: supply_v}}}
  send: {}
"""


def bench(folder: Path, timeout: str) -> Path:
    (folder / "x.dbc").write_text(DATABASE)
    (folder / "bench.yaml").write_text(BENCH.replace("TIMEOUT", timeout))
    return folder / "bench.yaml"


class OneFrame:
    up, missed = True, 0

    def __init__(self, data: bytes) -> None:
        self.frames = [Frame(288, data, False, False)]

    def receive_late(self, limit: int) -> list[Any]:
        return [(self.frames.pop(), None)] if self.frames else []

    receive = receive_late


@pytest.mark.parametrize(
    ("data", "rejected"),
    [
        (b"\1\x10\x05\0", {}),
        (b"\3\x10\x05\0", {"relay_on": -2.0}),
        (b"\1\x20\x80\0", {"supply_v": 328.0}),
        (b"\3\x20\x80\0", {"relay_on": -2.0, "supply_v": 328.0}),
    ],
)
def test_values_beyond_their_range_are_named(tmp_path: Path, data: bytes, rejected: dict[str, float]) -> None:
    made = load_bench(bench(tmp_path, "timeout_ms: 70"))
    values = [0.0] * len(INPUTS)
    node = Node(made.receive, (), OneFrame(data), LinkSettings(), values)  # type: ignore[arg-type]
    node.receive(0)
    named = {INPUTS[target].name: value for (_, target), value in node.rejected().items()}
    assert named == rejected
    assert node.counts[STATUS_INDEX["out_of_range"]] == bool(rejected)
    assert values[INPUT_INDEX["supply_v"]] == (0.0 if rejected else 12.96)


def test_the_benchs_timeout_is_for_messages_without_a_cycle_time(tmp_path: Path) -> None:
    assert load_bench(bench(tmp_path, "timeout_ms: 70")).receive[0].timeout_ns == 70_000_000
    (problem,) = check_bench(bench(tmp_path, ""))
    assert "the database gives Cmd no cycle time; 0 is unsupervised; bus.timeout_ms is for all" in problem.text
