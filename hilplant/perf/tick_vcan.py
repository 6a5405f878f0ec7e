"""The cost of a tick on SocketCAN: here when vcan0 exists, else in a process that is given a private one."""

import sys
from pathlib import Path
from typing import Any

from hilplant.perf.busy_bus import VCAN
from hilplant.perf.machine import is_user_mode_linux
from hilplant.perf.own_process import figures_of, hand_back
from hilplant.perf.results import PartResult
from hilplant.perf.tick_cost import tick_part, tick_times

_PRIVATE_VCAN = (sys.executable, "-m", "hilplant.vcan.private_vcan", "--limit", "300")


def measure() -> PartResult:
    """Measure on vcan0, wherever it can be had."""
    here = Path("/sys/class/net/vcan0").exists()
    result = _measured() if here else figures_of("hilplant.perf.tick_vcan", inside=_PRIVATE_VCAN)
    kernel = "User Mode Linux" if result["user_mode_linux"] else "this kernel"
    measured = tick_part(result["times"], "tick_vcan", f"vcan ({kernel})")
    measured.figures["tick_vcan_kernel"] = kernel
    return measured


def _measured() -> dict[str, Any]:
    return {"times": tick_times(VCAN), "user_mode_linux": is_user_mode_linux()}


if __name__ == "__main__":
    hand_back(_measured())
