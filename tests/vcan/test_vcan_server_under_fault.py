"""The daemon on a real SocketCAN that misbehaves: clients that stop, links that go down, queues, floods."""

import platform
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest
from support.can_utils import (
    PATIENCE_S,
    SLOW,
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
    candump: Any, shared_server: Any, vcan: str, commander: Commander, request: pytest.FixtureRequest
) -> None:
    candump.wait_for(" 210#", count=2)
    for _ in range(10):
        subprocess.run(["ip", "link", "set", vcan, "down"], check=True)
        time.sleep(0.15)
        subprocess.run(["ip", "link", "set", vcan, "up"], check=True)
        time.sleep(0.6)
    assert shared_server.process.poll() is None
    frames = request.getfixturevalue("plant_frames")  # candump ends when its link goes down
    commander.hold(SLOW)
    frames.wait_for("5E1A", patience_s=PATIENCE_S)  # 13.5 V as the terminal voltage of MotorStatus
    assert wait_until(lambda: bool(observed(frames, "LossFaults")))
    assert last(frames, "LossFaults")["LinkDown"] == 10


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
