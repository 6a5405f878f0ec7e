"""The daemon on a real SocketCAN that misbehaves: clients that stop, links that go down, queues, floods."""

import json
import os
import platform
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.can_utils import (
    HILPLANT,
    PATIENCE_S,
    SLOW,
    SOFT_TIME,
    Commander,
    last,
    observed,
    wait_until,
)


def test_a_client_that_stops_mid_way_leaves_the_wiper_in_the_safe_state(
    candump: Any, shared_server: Any, commander: Commander
) -> None:
    commander.hold(SLOW)
    assert wait_until(lambda: last(candump, "MotorStatus")["CrankSpeed"] > 3.0)
    commander.stop()
    assert wait_until(lambda: str(last(candump, "PlantStatus")["Mode"]) == "Safe")
    assert wait_until(lambda: last(candump, "MotorStatus")["TerminalVoltage"] == 0.0)
    assert wait_until(lambda: abs(last(candump, "MotorStatus")["CrankSpeed"]) < 1e-3)
    assert wait_until(lambda: last(candump, "LinkFaults")["Timeouts"] >= 1)
    assert shared_server.process.poll() is None


def test_the_link_goes_down_and_up_ten_times_and_the_loop_ticks_on(
    candump: Any, shared_server: Any, vcan: str, cansend: Callable[[str], None]
) -> None:
    candump.wait_for(" 210#", count=2)
    for _ in range(10):
        subprocess.run(["ip", "link", "set", vcan, "down"], check=True)
        time.sleep(0.15)
        subprocess.run(["ip", "link", "set", vcan, "up"], check=True)
        time.sleep(0.6)
    assert shared_server.process.poll() is None
    candump.lines.clear()
    cansend(SLOW)
    assert wait_until(lambda: bool(observed(candump, "MotorStatus")) and bool(observed(candump, "LinkFaults")))
    assert wait_until(lambda: last(candump, "MotorStatus")["TerminalVoltage"] == 13.5), "the last command was taken"
    assert last(candump, "LinkFaults")["LinkDown"] == 10


def throttle(interface: str) -> None:
    """Let the interface pass about 60 frames a second, with room for 25 more; further ones are refused with ENOBUFS."""
    words = ["tc", "qdisc", "add", "dev", interface, "root", "tbf", "rate", "8kbit", "burst", "100b", "limit", "400b"]
    if subprocess.run(words, check=False, stderr=subprocess.DEVNULL).returncode:
        release = platform.release()
        (module,) = Path("/").glob(f"usr/lib/uml/modules/{release}/kernel/net/sched/sch_tbf.ko")
        subprocess.run(["insmod", str(module)], check=True)
        subprocess.run(words, check=True)


def test_a_full_queue_drops_and_counts_frames_and_the_bus_recovers(candump: Any, shared_server: Any, vcan: str) -> None:
    candump.wait_for(" 200#", count=20)
    throttle(vcan)
    time.sleep(2.0)
    assert shared_server.process.poll() is None
    subprocess.run(["tc", "qdisc", "del", "dev", vcan, "root"], check=True)
    candump.lines.clear()
    candump.wait_for(" 213#", count=3)  # the first may have been under way before
    dropped = [signals["QueueFull"] for _, signals in observed(candump, "LinkFaults")]
    print(f"{dropped[-1]} frames dropped in 2 s at 60 frames a second")
    assert dropped[-1] > 50
    assert dropped[-1] == dropped[-2], "nothing is dropped any more"


#: As many as a guest takes in half a minute; `HILPLANT_FLOOD=1000000` for more.
FRAMES = int(os.environ.get("HILPLANT_FLOOD", "200000"))
FLOOD = """
import random, socket, struct, sys

source = random.Random(7)
lengths = {0x120: 2, 0x121: 2, 0x122: 3, 0x123: 8}


def random_frame():
    kind = source.random()
    can_id = source.choice(tuple(lengths)) if kind < 0.5 else source.randrange(0x300, 1 << 11)
    if kind < 0.1:
        can_id = source.randrange(1 << 29) | 0x80000000
    if 0.1 < kind < 0.15:
        can_id |= 0x40000000
    if 0.15 < kind < 0.2:  # the kernel passes on no error frame without a class
        can_id = source.randrange(1, 1 << 9) | 0x20000000
    if 0.2 < kind < 0.3:
        length = source.choice((0, 1, 2, 3, 8, 12, 48, 64))
        return struct.pack("=IBBBB64s", can_id, length, 0, 0, 0, source.randbytes(64)), False
    length, data = source.randrange(9), source.randbytes(8)
    valid = lengths.get(can_id) == length
    valid = valid and (can_id != 0x121 or data[0] + 256 * data[1] <= 40_000)
    valid = valid and (can_id != 0x122 or (data[0] & 3 < 3 and data[1] + 256 * data[2] <= 10_000))
    valid = valid and (can_id != 0x123 or all(-100 <= raw <= 100 for raw in struct.unpack("=bb6x", data)))
    return struct.pack("=IB3x8s", can_id, length, data), valid


frames = [random_frame() for _ in range(20_000)]
bus = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
bus.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FD_FRAMES, 1)
bus.bind(("vcan0",))
rounds = int(sys.argv[1]) // len(frames)
for _ in range(rounds):
    for frame, _ in frames:
        bus.send(frame)
print("flooded", rounds * len(frames), "valid", rounds * sum(valid for _, valid in frames), flush=True)
"""


def dropped_by_the_kernel() -> int:
    """Return the frames that overflowed the kernel's queue in front of all sockets: no socket ever hears of them."""
    rows = Path("/proc/net/softnet_stat").read_text().splitlines()
    return sum(int(row.split()[1], 16) for row in rows)


@pytest.mark.timeout(900)
def test_a_flood_of_random_frames_leaves_the_loop_running(
    plant_frames: Any, spawn: Callable[..., Any], tmp_path: Path, cansend: Callable[[str], None]
) -> None:
    server = spawn(*HILPLANT, "run", SOFT_TIME, "--json", tmp_path / "run.json")
    plant_frames.wait_for(" 210#", count=2, patience_s=60)
    dropped_before = dropped_by_the_kernel()
    flood = spawn(sys.executable, "-c", FLOOD, str(FRAMES))
    flood.wait_for(f"flooded {FRAMES}", 800)
    wrong = FRAMES - int(flood.output.split()[-1])
    assert server.process.poll() is None, "the daemon lives"
    assert wait_until(lambda: str(last(plant_frames, "PlantStatus")["Mode"]) == "Safe")
    plant_frames.lines.clear()
    cansend("121#BC34")  # 13.5 V, whatever the flood left
    cansend(SLOW)
    plant_frames.wait_for("5E1A")  # as the terminal voltage of MotorStatus
    assert server.end(patience_s=PATIENCE_S) == 0
    figures = json.loads((tmp_path / "run.json").read_text())
    causes = ("unknown_frame", "wrong_length", "remote_frame", "fd_frame", "error_frame", "out_of_range")
    counts = {cause: figures[f"counts_{cause}"] for cause in causes}
    missed, dropped = figures["counts_missed_frame"], dropped_by_the_kernel() - dropped_before
    print(f"{counts}, missed {missed}, dropped {dropped}, of {wrong} wrong frames in {figures['ticks']} ticks")
    assert all(counts.values())
    assert sum(counts.values()) <= wrong <= sum(counts.values()) + missed + dropped, "each by its cause, or as missed"
