"""Whether a server that runs for hours grows: whole ticks, frames and ring included, on the virtual clock."""

import os
import sys
import time
from pathlib import Path
from typing import Any

from hilplant.bench import load_bench
from hilplant.perf.busy_bus import VIRTUAL, Peer, both_ends
from hilplant.perf.own_process import figures_of, hand_back
from hilplant.perf.results import Goal, PartResult, Row
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.ring import Ring
from hilplant.runtime.row import ROW_WIDTH
from hilplant.runtime.server import build_loop
from hilplant.runtime.watchdog import Watchdog
from hilplant.units import SECOND_NS

_WALL_S = 60.0
_FULL_HOURS = 10.0
_HOUR_S = 3600.0
_WARM_UP_TICKS = 60_000
#: The peer commands and drains once in so many ticks, about as often as a body computer does.
_PEER_TICKS = 10
_GOAL_MB = 1.0
_PAGE_MB = os.sysconf("SC_PAGE_SIZE") / 1e6


def measure() -> PartResult:
    """Simulate as many hours as fit into a minute."""
    return _part(figures_of("hilplant.perf.memory", str(_WALL_S)))


def measure_full() -> PartResult:
    """Simulate ten hours, however long that takes."""
    return _part(figures_of("hilplant.perf.memory", "inf"))


def _part(result: dict[str, Any]) -> PartResult:
    start_mb, end_mb, hours = result["start_mb"], result["end_mb"], result["simulated_h"]
    growth_mb = end_mb - start_mb
    rows = [
        Row(f"resident, {hours:.2f} h simulated", end_mb, "MB", start_mb, "after 60 s"),
        Row("growth", growth_mb, "MB", goal=Goal(_GOAL_MB, of_ratio=False)),
    ]
    figures: dict[str, float | str] = {
        "memory_start_mb": start_mb,
        "memory_end_mb": end_mb,
        "memory_growth_mb": growth_mb,
        "memory_simulated_h": hours,
    }
    remark = f"{result['ticks']} ticks and {result['frames']} frames in {result['wall_s']:.0f} s of real time"
    return PartResult(rows, figures, [remark])


def resident_mb() -> float:
    """Return how much memory this process really holds."""
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * _PAGE_MB


class PeerClock(VirtualClock):
    """The virtual clock; while the loop sleeps, the peer sends and drains, and once the memory is noted."""

    def __init__(self, peer: Peer) -> None:
        """Start at 0."""
        super().__init__()
        self.frames = 0
        self.start_mb = 0.0
        self._peer = peer
        self._sleeps = 0

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Let the peer act when it is its turn, then jump."""
        super().sleep_until_ns(deadline_ns)
        self._sleeps += 1
        if self._sleeps % _PEER_TICKS == 0:
            self._peer.send()
            self.frames += self._peer.drain()
        if self._sleeps == _WARM_UP_TICKS:
            self.start_mb = resident_mb()


def run_for(hours: float, wall_s: float) -> dict[str, Any]:
    """Run the loop for so many simulated hours, or until the wall clock says that it is enough."""
    bench = load_bench("default")
    begin = time.monotonic()
    with both_ends(VIRTUAL) as ends:
        clock = PeerClock(Peer(bench, ends.peer))
        ring = Ring.create(ROW_WIDTH)
        loop = build_loop(bench, ends.plant, clock, ring)
        ticks = round(hours * _HOUR_S * SECOND_NS / bench.step_ns)
        loop.run(ticks, lambda: time.monotonic() - begin > wall_s, Watchdog())
        ring.close()
    return {
        "start_mb": clock.start_mb,
        "end_mb": resident_mb(),
        "simulated_h": clock.time_ns / SECOND_NS / _HOUR_S,
        "ticks": loop.progress.ticks,
        "frames": clock.frames,
        "wall_s": time.monotonic() - begin,
    }


if __name__ == "__main__":
    hand_back(run_for(_FULL_HOURS, float(sys.argv[1])))
