"""The interface that the other tests in this folder stand on really is SocketCAN: can-utils alone talk over it."""

import subprocess
from collections.abc import Callable
from typing import Any

import pytest

Send = Callable[[str], None]


def test_a_sent_frame_is_seen_by_an_independent_listener(candump: Any, cansend: Send) -> None:
    cansend("123#11223344")
    assert candump.wait_for("123#11223344")[0].endswith("vcan0 123#11223344")


def test_extended_remote_and_fd_frames_keep_their_kind(candump: Any, cansend: Send) -> None:
    cansend("12345678#AA")
    assert candump.wait_for(" 12345678#AA")
    cansend("123#R")
    assert candump.wait_for(" 123#R")
    cansend("124##1" + "5A" * 64)
    (line,) = candump.wait_for(" 124##")
    flags, data = int(line[-129], 16), line[-128:]
    assert flags & 1, "the bit rate switch is kept; newer kernels add a flag of their own"
    assert data == "5A" * 64


def test_a_thousand_generated_fd_frames_all_arrive(candump: Any, vcan: str) -> None:
    subprocess.run(["cangen", vcan, "-f", "-I", "321", "-n", "1000", "-g", "0", "-i"], check=True)
    assert len(candump.wait_for(" 321##", count=1000)) == 1000


def test_the_link_can_be_taken_down_and_up(candump: Any, cansend: Send, vcan: str) -> None:
    subprocess.run(["ip", "link", "set", vcan, "down"], check=True)
    with pytest.raises(subprocess.CalledProcessError):
        cansend("123#01")
    subprocess.run(["ip", "link", "set", vcan, "up"], check=True)
    subprocess.run(["cansend", vcan, "123#02"], check=True)


def test_a_spawned_program_is_ended_by_a_signal(spawn: Callable[..., Any], vcan: str) -> None:
    listener = spawn("stdbuf", "-oL", "candump", vcan)
    while "7FE" not in listener.output:
        subprocess.run(["cansend", vcan, "7FE#"], check=True)
    assert listener.end() == -15 or listener.process.returncode in (0, 130, 143)
