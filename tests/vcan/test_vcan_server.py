"""The daemon on real SocketCAN, with can-utils as the only client: commands by cansend, observation by candump.

Frames are read with cantools from the shipped database, never with hilplant's own codec.
"""

import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.can_utils import (
    DATABASE,
    FAST,
    HILPLANT,
    SLOW,
    Commander,
    last,
    observed,
    wait_until,
)

ROOT = Path(__file__).parents[2]
#: Off at the edge of the park switch, as an ECU does it: slow until the contact has opened and closed again.
PARK = """
cangen "$0" -g 50 -I 120 -L 2 -D 0100 & slow=$!
stdbuf -oL candump -L "$0,201:7FF" | while read -r line; do
    case $line in
        *"#00") opened=1 ;;
        *"#01") [ -z "$opened" ] || { kill $slow; cansend "$0" 120#0000; break; } ;;
    esac
done
"""


def test_can_utils_alone_drive_the_wiper_slow_fast_and_park_it(
    candump: Any, shared_server: Any, commander: Commander, vcan: str
) -> None:
    def crank_speed() -> float:
        return float(last(candump, "MotorStatus")["CrankSpeed"])

    commander.hold(SLOW)
    candump.wait_for(" 200#")
    assert wait_until(lambda: 3.9 < crank_speed() < 4.7), "no-load speed of Table 5-9 on the slow brush"
    assert last(candump, "MotorStatus")["TerminalVoltage"] == 13.5
    slow = crank_speed()
    commander.hold(FAST)
    assert wait_until(lambda: 1.2 < crank_speed() / slow < 1.45), "the fast brush's constant is smaller by 1.34"
    commander.stop()

    def parked_deg() -> float:
        subprocess.run(["bash", "-c", PARK, vcan], check=True, timeout=60)
        assert wait_until(lambda: crank_speed() == 0.0)
        angle = last(candump, "Linkage")["CrankAngle"]
        from_park_deg = (math.degrees(angle) + 180.0) % 360.0 - 180.0
        print(f"stopped {from_park_deg:.1f} deg from park")
        return from_park_deg

    # The window begins at -7 deg, braking takes 4; the rest is this client's delay, up to 0.15 s where others compute.
    assert any(abs(parked_deg()) < 20.0 for _ in range(3))


def test_cantools_on_the_command_line_shows_the_frames_in_plain_units(candump: Any, shared_server: Any) -> None:
    lines = "\n".join(candump.wait_for(" 200#", count=3))
    decode = [sys.executable, "-m", "cantools", "decode", str(ROOT / "dbc" / "wiper.dbc")]
    shown = subprocess.run(decode, input=lines, capture_output=True, text=True, check=True).stdout
    assert "TerminalVoltage: 0.0 V" in shown.replace("0 V", "0.0 V").replace("0.0.0", "0.0")
    assert "MotorCurrent" in shown


def mean_periods_ms(candump: Any) -> dict[str, float]:
    """Return the mean period of each cyclic message over the next 600 frames of the fastest [ms]."""
    candump.lines.clear()
    candump.wait_for(" 202#", count=600, patience_s=30)
    means = {}
    for name in ("MotorStatus", "Linkage", "PlantStatus"):
        times = [stamp for stamp, _ in observed(candump, name)]
        means[name] = (times[-1] - times[0]) / (len(times) - 1) * 1000.0
    return means


def test_frame_periods_are_those_of_the_database_within_one_percent(candump: Any, shared_server: Any) -> None:
    # The guest has one processor of a host that may be busy; periods that the host took away are skipped, not made up.
    for _ in range(5):
        means = mean_periods_ms(candump)
        print({name: f"{mean:.3f} ms" for name, mean in means.items()}, last(candump, "PlantStatus")["Overruns"])
        cycles = {name: DATABASE.get_message_by_name(name).cycle_time for name in means}
        if means == pytest.approx(cycles, rel=0.01):
            return
    pytest.fail("in none of five windows was the mean within 1 % of the cycle time")


def test_a_missing_interface_is_one_line_and_nothing_starts(spawn: Callable[..., Any]) -> None:
    result = subprocess.run([*HILPLANT, "run", "--channel", "can7"], capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1
    assert "can7" in result.stderr
