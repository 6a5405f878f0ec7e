"""The daemon on a real SocketCAN under a flood of random frames."""

import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.can_utils import HILPLANT, PATIENCE_S, SLOW, SOFT_TIME, last, wait_until

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
