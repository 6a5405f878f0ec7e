"""A private interface is private, and a command in it runs as if started directly.

The kernel here has CAN, so this proves the way through namespaces.
"""

import subprocess
import sys
from pathlib import Path
from typing import Any

HARNESS = (sys.executable, "-m", "hilplant.vcan.private_vcan")


def private(*command: str, text: str = "", folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    words = [*HARNESS, *command]
    return subprocess.run(words, input=text, cwd=folder, capture_output=True, text=True, timeout=60, check=False)


def test_a_frame_on_a_private_interface_stays_there(candump: Any, cansend: Any) -> None:
    assert private("cansend", "vcan0", "111#01").returncode == 0
    cansend("222#02")
    candump.wait_for(" 222#02")
    assert not [line for line in candump.lines if " 111#01" in line]


def test_streams_folder_and_exit_code_are_the_command_s(vcan: str, tmp_path: Path) -> None:
    result = private("sh", "-c", "cat; pwd; ls /sys/class/net; echo wrong >&2; exit 7", text="given\n", folder=tmp_path)
    assert result.stdout.split() == ["given", str(tmp_path), "lo", vcan]
    assert (result.stderr, result.returncode) == ("wrong\n", 7)


def test_a_command_beyond_its_limit_is_ended_with_one_line(vcan: str) -> None:
    result = private("--limit", "1", "sleep", "100")
    assert result.returncode == 2
    assert result.stderr == "vcan: ended sleep after its limit of 1 s\n"
