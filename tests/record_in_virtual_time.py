"""Record a long run in virtual time, in parts, and look at what it left.

python tests/record_in_virtual_time.py run.hilrec --hours 24 --rotate 100MB,1h --keep 24

A random driver as in the soak; what the recorder does each half second is done here in the same process. Checked at the
end: the parts that are kept follow each other tick by tick, and the last one replays bit for bit. Exit code 1 if not.
"""

import argparse
import resource
import sys
import time
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, cast

import numpy as np
from soak import Car

from hilplant.bench import Bench, load_bench
from hilplant.bus.in_memory import InMemoryBus
from hilplant.ecu.node import EcuNode
from hilplant.ecu.settings import controller_settings
from hilplant.recording.metadata import describe
from hilplant.recording.reader import read_recording
from hilplant.recording.replay import replay
from hilplant.recording.rotation import Rotation
from hilplant.recording.writer import RecordingWriter
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.loop import ROW_WIDTH
from hilplant.runtime.ring import Ring
from hilplant.runtime.server import build_loop
from hilplant.units import MILLISECOND_NS, SECOND_NS

WRITES_PER_S = 2


def record(bench: Bench, path: Path, rotation: Rotation, seconds: int, seed: int) -> Iterator[int]:
    """Record so many seconds; yield after each how many have passed."""
    bus, ring, car = InMemoryBus(), Ring.create(ROW_WIDTH), Car(seed)
    loop = build_loop(bench, cast("Any", bus.end()), VirtualClock(), ring)
    loop.control = car
    ecu = EcuNode(bench.ecu_side(), cast("Any", bus.end()), controller_settings(bench.ecu))
    poll_ticks = round(bench.ecu.period_ms * MILLISECOND_NS / bench.step_ns)
    per_write = SECOND_NS // bench.step_ns // WRITES_PER_S
    writer = RecordingWriter(path, describe(bench, datetime.now(UTC)), ROW_WIDTH, rotation)
    tick = 0
    for second in range(1, seconds + 1):
        for _ in range(WRITES_PER_S):
            for _ in range(per_write):
                now_ns = tick * bench.step_ns
                loop.tick(now_ns)
                if tick % poll_ticks == 0:
                    ecu.poll(now_ns, car.at(now_ns / SECOND_NS))
                tick += 1
            writer.take(ring)
            writer.write()
        yield second
    writer.write(last=True)
    writer.close(ring.lost)
    ring.close()


def gaps(path: Path) -> tuple[int, int, int]:
    """Return first and last tick that is kept, and how many between them are not."""
    first, last, rows = -1, -1, 0
    for block in read_recording(path).batches():
        ticks = block.column("tick").to_numpy()
        if len(ticks):
            first, last, rows = ticks[0] if first < 0 else first, ticks[-1], rows + len(np.unique(ticks))
    return int(first), int(last), int(last - first + 1 - rows)


def main() -> int:
    """Record, look, and say what was found."""
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("path", type=Path)
    asked.add_argument("--hours", type=float, default=24.0)
    asked.add_argument("--bench", default="default")
    asked.add_argument("--rotate")
    asked.add_argument("--keep", type=int)
    asked.add_argument("--seed", type=int, default=7)
    given = asked.parse_args()
    began_s, seconds = time.monotonic(), round(given.hours * 3600)
    rotation = Rotation.parse(given.rotate, given.keep)
    bench = load_bench(given.bench)
    for second in record(bench, given.path, rotation, seconds, given.seed):
        if second % 600 == 0 or second == seconds:
            memory_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            sys.stdout.write(f"{second} s in {time.monotonic() - began_s:.0f} s, memory {memory_mb:.1f} MB\n")
            sys.stdout.flush()
    parts = read_recording(given.path).parts
    first, last, missing = gaps(given.path)
    again = replay(parts[-1])
    size_mb = sum(part.stat().st_size for part in parts) / 1e6
    sys.stdout.write(f"{len(parts)} files, {size_mb:.1f} MB, {size_mb / (last - first + 1) * 6e4:.2f} MB a minute\n")
    sys.stdout.write(f"ticks {first} to {last}, {missing} missing; {parts[-1].name}: {again}\n")
    return 0 if again.equal and not missing and last + 1 == seconds * SECOND_NS // bench.step_ns else 1


if __name__ == "__main__":
    sys.exit(main())
