"""Plant and ECU as two processes on SocketCAN, the stalk by cansend, everything seen by candump.

Times are those at which the kernel saw the frames. Payloads come from cantools and the shipped database, never from
hilplant's own codec.
"""

import math
import re
import sys
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import cantools

ROOT = Path(__file__).parents[2]
DATABASE = cantools.database.load_file(ROOT / "dbc" / "wiper.dbc")
LINE = re.compile(r"\((\d+\.\d+)\) \S+ ([0-9A-F]{3})#([0-9A-F]*)$")
HILPLANT = (sys.executable, "-m", "hilplant")
PATIENCE_S = 40.0
#: Where the cache of compiled code is cold, a guest compiles for minutes before it serves.
START_PATIENCE_S = 300.0
#: Of each pause so many periods are measured at most.
MOST_PERIODS = 6
STARTS = ("RelayCommand", "RelayOn", "On")
PAUSES_S = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
#: As few frames as the test needs: a guest of User Mode Linux has one slow processor for everything in it.
BENCH = f"""
extends: polynomial.yaml
name: two processes
inputs: {{supply_v: 16}}
bus:
  send:
    MotorStatus: {{period_ms: 50, signals: {{MotorCurrent: current_a}}}}
    ParkSwitch: {{on_change: [park_contact], signals: {{ParkContact: park_contact}}}}
    Linkage: {{period_ms: 100, signals: {{CrankAngle: crank_angle_rad}}}}
ecu: {{pauses_s: {list(PAUSES_S)}}}
"""


class Watcher:
    """The frames of ECU, park switch and linkage as they come, by message; unchanged ones are passed over."""

    WATCHED = ("RelayCommand", "EcuStatus", "ParkSwitch", "Linkage")

    def __init__(self, candump: Any) -> None:
        self._names = {DATABASE.get_message_by_name(name).frame_id: name for name in self.WATCHED}
        self.candump = candump
        self._line = 0
        self._last: dict[str, str] = {}
        self.changes: dict[str, list[tuple[float, dict[str, Any]]]] = {name: [] for name in self.WATCHED}

    def look(self) -> None:
        """Take in what has come since the last look."""
        lines = self.candump.lines[self._line :]
        self._line += len(lines)
        for line in lines:
            match = LINE.match(line)
            name = self._names.get(int(match[2], 16)) if match else None
            if match and name and self._last.get(name) != match[3]:
                self._last[name] = match[3]
                signals = DATABASE.decode_message(name, bytes.fromhex(match[3]))
                self.changes[name].append((float(match[1]), signals))

    def times(self, name: str, signal: str, value: str) -> list[float]:
        """Return when a signal came to a value."""
        seen = [(at_s, str(signals[signal])) for at_s, signals in self.changes[name]]
        return [at_s for (_, before), (at_s, after) in pairwise([(0.0, ""), *seen]) if before != after == value]

    def wait_after(self, act: Callable[[], None], expected: tuple[str, str, str], count: int = 1) -> None:
        """Act, and return once message and signal have come to a value so many times after that."""
        self.look()
        known = len(self.times(*expected))
        act()
        end_s = time.monotonic() + PATIENCE_S
        while len(self.times(*expected)) < known + count:
            last = {name: changes[-1:] for name, changes in self.changes.items()}
            assert time.monotonic() < end_s, f"never {expected}; last: {last}"
            time.sleep(0.1)
            self.look()


def stalk_frame(position: str, interval: int = 1, flick: int = 0) -> str:
    signals = {
        "Master_Input": position,
        "Intermittent_Switch": interval,
        "Flick_Wipe": flick,
        "Wash": 0,
        "Automatic": 0,
    }
    return f"110#{DATABASE.encode_message('StalkCommand', signals).hex()}"


def test_a_stalk_by_cansend_through_all_stages(
    ecu_frames: Any, spawn: Any, cansend: Callable[[str], None], tmp_path: Path
) -> None:
    seen, bench = Watcher(ecu_frames), tmp_path / "bench.yaml"
    bench.write_text(BENCH)
    spawn(*HILPLANT, "run", bench).wait_for("serves on", START_PATIENCE_S)
    ecu = spawn(*HILPLANT, "ecu", bench)
    ecu.wait_for("relays OFF\n", START_PATIENCE_S)

    def stalk(position: str, interval: int = 1, flick: int = 0) -> Callable[[], None]:
        return lambda: cansend(stalk_frame(position, interval, flick))

    seen.wait_after(stalk("Off", flick=1), ("EcuStatus", "EcuState", "Flick"))
    seen.wait_after(stalk("Off"), ("EcuStatus", "EcuState", "Off"))
    assert seen.times("RelayCommand", "RelayFast", "Fast")
    assert_parked(seen)
    for interval, pause_s in enumerate(PAUSES_S, start=1):
        seen.wait_after(stalk("Intermittent", interval), STARTS, count=2)
        check_periods(seen, pause_s)
    for position in ("Slow", "Fast"):
        seen.wait_after(stalk(position), ("EcuStatus", "EcuState", position))
    seen.wait_after(stalk("Off"), ("EcuStatus", "EcuState", "Off"))
    assert_parked(seen)
    faults = {str(signals["EcuFault"]) for _, signals in seen.changes["EcuStatus"]}
    assert faults == {"None"}
    assert ecu.end(patience_s=PATIENCE_S) == 0


def check_periods(seen: Watcher, pause_s: float) -> None:
    """From a start to the next it takes the wipe, until the park switch closes, and the pause: within 10 ms.

    The host may hold the guest up now and then, so the best of some periods is judged: more than one if it must be. A
    pause that is wrong is wrong each time.
    """
    excesses = [excess_s(seen, pause_s, -1)]
    while min(map(abs, excesses)) > 0.010 and len(excesses) < MOST_PERIODS:
        seen.wait_after(lambda: None, STARTS)
        excesses.append(excess_s(seen, pause_s, -1))
    print(f"pause {pause_s} s: excess of the period", ", ".join(f"{excess * 1e3:.1f}" for excess in excesses), "ms")
    assert min(map(abs, excesses)) <= 0.010


def excess_s(seen: Watcher, pause_s: float, last: int) -> float:
    """By how much the period that ends with a start, counted from the last, is longer than wipe and pause."""
    starts = seen.times(*STARTS)
    start_s, next_s = starts[last - 1], starts[last]
    (arrival_s,) = [at_s for at_s in seen.times("ParkSwitch", "ParkContact", "Closed") if start_s < at_s < next_s]
    return next_s - arrival_s - pause_s


def assert_parked(seen: Watcher) -> None:
    """The contact is closed and the crank stands within the park window."""
    time.sleep(1.0)
    seen.look()
    assert str(seen.changes["ParkSwitch"][-1][1]["ParkContact"]) == "Closed"
    at_s, linkage = seen.changes["Linkage"][-1]
    assert abs(math.remainder(linkage["CrankAngle"], 2.0 * math.pi)) < math.radians(7.5)
    assert float(seen.candump.lines[-1][1:].split(")")[0]) - at_s > 0.3, "it stands"
