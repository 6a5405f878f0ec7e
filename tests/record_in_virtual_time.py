"""Record a long run in virtual time, in parts, and look at what it left.

python tests/record_in_virtual_time.py run.hilrec --hours 24 --rotate 100MB,1h --keep 24

A random driver as in the soak, or with --stalk one who never moves it; what the recorder does each half second is done
here in the same process. Checked at the end: the parts that are kept follow each other tick by tick, and the last one
replays bit for bit. Exit code 1 if not. --export tells size, time and most memory of an export to each format, and of a
minute.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
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
from hilplant.ecu.vocabulary import Master, Stalk
from hilplant.recording.metadata import describe
from hilplant.recording.reader import read_recording
from hilplant.recording.replay import replay
from hilplant.recording.rotation import Rotation
from hilplant.recording.writer import RecordingWriter
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.ring import Ring
from hilplant.runtime.row import ROW_WIDTH
from hilplant.runtime.server import build_loop
from hilplant.units import MILLISECOND_NS, SECOND_NS

WRITES_PER_S = 2
ENDINGS = ("csv", "parquet", "mf4", "blf", "asc")
#: In a process of its own, so that its memory is the export's; ru_maxrss would be the parent's if that had more.
EXPORT = """
import re, sys
from pathlib import Path
from hilplant.recording.export import export
from hilplant.recording.span import Span
export(sys.argv[1], sys.argv[2], Span(float(sys.argv[3]), float(sys.argv[4])))
print(int(re.search(r"VmHWM:\\s+(\\d+) kB", Path("/proc/self/status").read_text())[1]) / 1024)
"""


class SameStalk(Car):
    """A driver who holds the stalk in one stage, in rain, on a good supply."""

    def __init__(self, master: Master) -> None:
        super().__init__(seed=1)
        self.stalk, self.screen = Stalk(master), 1.0

    def at(self, _time_s: float) -> Stalk:
        """Return the stalk."""
        return self.stalk


def record(bench: Bench, path: Path, rotation: Rotation, seconds: int, car: Car) -> Iterator[int]:
    """Record so many seconds; yield after each how many have passed."""
    bus, ring = InMemoryBus(), Ring.create(ROW_WIDTH)
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


def tell_exports(path: Path, seconds: int) -> None:
    """Export to each format, all of it and the middle minute, and say what that took."""
    spans = {"all": (0.0, float(seconds)), "a minute": (seconds / 2, seconds / 2 + 60)}
    for ending in ENDINGS:
        for name, (from_s, to_s) in spans.items():
            with tempfile.TemporaryDirectory(dir=path.parent) as folder:
                out, began_s = Path(folder) / f"x.{ending}", time.monotonic()
                words = [sys.executable, "-c", EXPORT, str(path), str(out), str(from_s), str(to_s)]
                memory = subprocess.run(words, check=True, capture_output=True, text=True).stdout
                sys.stdout.write(
                    f".{ending}, {name}: {out.stat().st_size / 1e6:.1f} MB in {time.monotonic() - began_s:.0f} s, "
                    f"memory {float(memory.split()[-1]):.0f} MB\n"
                )
                sys.stdout.flush()


def main() -> int:
    """Record, look, and say what was found."""
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("path", type=Path)
    asked.add_argument("--hours", type=float, default=24.0)
    asked.add_argument("--bench", default="default")
    asked.add_argument("--rotate")
    asked.add_argument("--keep", type=int)
    asked.add_argument("--seed", type=int, default=7)
    asked.add_argument("--stalk", choices=[stage.name.lower() for stage in Master], help="held all the time")
    asked.add_argument("--export", action="store_true", help="tell what an export to each format takes")
    given = asked.parse_args()
    began_s, seconds = time.monotonic(), round(given.hours * 3600)
    rotation = Rotation.parse(given.rotate, given.keep)
    bench = load_bench(given.bench)
    car = Car(given.seed) if given.stalk is None else SameStalk(Master[given.stalk.upper()])
    for second in record(bench, given.path, rotation, seconds, car):
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
    if given.export:
        tell_exports(given.path, seconds)
    return 0 if again.equal and not missing and last + 1 == seconds * SECOND_NS // bench.step_ns else 1


if __name__ == "__main__":
    sys.exit(main())
