"""The daemon with can-utils as its only client; frames are read with cantools from the shipped database."""

import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cantools

ROOT = Path(__file__).parents[2]
DATABASE = cantools.database.load_file(ROOT / "dbc" / "wiper.dbc")
LINE = re.compile(r"\((\d+\.\d+)\) \S+ ([0-9A-F]{3})#([0-9A-F]*)$")
SLOW, FAST, OFF = "120#0100", "120#0300", "120#0000"
PATIENCE_S = 40.0
START_PATIENCE_S = 150.0
#: The default bench where time is soft.
SOFT_TIME = ROOT / "tests" / "vcan" / "soft_time.yaml"
HILPLANT = (sys.executable, "-m", "hilplant")
#: Sends a frame by cansend every 0.1 s, and at once each one that comes by standard input; ends with it.
COMMANDER = """
frame=120#0000
while :; do
    read -r -t 0.1 new && frame=$new || [ $? -gt 128 ] || exit 0
    cansend "$0" "$frame"
done
"""


class Commander:
    """Sends one relay command over and over with cansend, as an ECU does, until told another."""

    def __init__(self, interface: str) -> None:
        # A small process of its own: starting a program from this one takes a tenth of a second in User Mode Linux.
        words = ["bash", "-c", COMMANDER, interface]
        self._shell = subprocess.Popen(words, stdin=subprocess.PIPE, text=True)

    def hold(self, frame: str) -> None:
        assert self._shell.stdin is not None
        self._shell.stdin.write(f"{frame}\n")
        self._shell.stdin.flush()

    def stop(self) -> None:
        assert self._shell.stdin is not None
        self._shell.stdin.close()
        self._shell.wait(PATIENCE_S)


def observed(candump: Any, name: str) -> list[tuple[float, dict[str, Any]]]:
    """Return (time, signals) of every frame of one message that candump has seen."""
    message = DATABASE.get_message_by_name(name)
    found = []
    for line in list(candump.lines):
        match = LINE.match(line)
        if match and int(match[2], 16) == message.frame_id:
            found.append((float(match[1]), message.decode(bytes.fromhex(match[3]))))
    return found


def last(candump: Any, name: str) -> dict[str, Any]:
    """Return the signals of the newest frame of a message; wait for its first one."""
    message = DATABASE.get_message_by_name(name)

    def newest() -> str | None:
        matches = (LINE.match(line) for line in reversed(list(candump.lines)))
        return next((match[3] for match in matches if match and int(match[2], 16) == message.frame_id), None)

    assert wait_until(lambda: newest() is not None), f"no {name} was seen"
    signals: dict[str, Any] = message.decode(bytes.fromhex(newest() or ""))
    return signals


def wait_until(condition: Callable[[], bool], seconds: float = 10.0) -> bool:
    deadline = time.monotonic() + seconds
    while not condition() and time.monotonic() < deadline:
        time.sleep(0.05)
    return condition()
