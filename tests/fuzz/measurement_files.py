"""Random mutations of good measurement files: each is read, or refused in one line, within bounds of time and memory.

`python tests/fuzz/measurement_files.py 20000` runs that many cases and exits with 1 when one of them did anything else.
"""

import importlib
import random
import resource
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import can
import can.io.mf4
import numpy as np
import pyarrow as pa
from pyarrow import parquet

from hilplant.failure import Failure
from hilplant.measurements.files import Origin, read_channels
from hilplant.measurements.frames import FrameSource

DBC = """VERSION ""
BU_: RIG
BO_ 256 Motor: 4 RIG
 SG_ Amps : 0|16@1- (0.01,0) [-300|300] "A" RIG
 SG_ Volts : 16|16@1+ (0.001,0) [0|40] "V" RIG
BO_ 257 Switch: 1 RIG
 SG_ Park : 0|1@1+ (1,0) [0|1] "" RIG
"""
#: A case may last so long [s], and the process may have so much memory [KiB].
LONGEST_S, MOST_KIB = 20, 1 << 20
COUNT = 120
#: MF4 takes a process for each case, so it comes more seldom than the others.
MF4_PART = 0.1


def good_files(folder: Path) -> list[Path]:
    """Write a small good file of each format."""
    times = np.arange(COUNT) * 1e-3
    rows = [f"{t:.3f};{12.0 * (t > 0.02):.2f};{t:.3f};{int(t < 0.01)}" for t in times]
    (folder / "a.csv").write_text("\n".join(["time [s];voltage [V];current [A];park", *rows]))
    (folder / "b.csv").write_text(
        "\n".join(["date,u,on", *(f"2026-11-28 12:00:00.{k:03d},{k},True" for k in range(99))])
    )
    (folder / "c.txt").write_bytes("\n".join(["Zeit\tU\tI", *(f"{k},5\t{k}\t1" for k in range(99))]).encode("utf-16"))
    table = {"time": times, "voltage": times, "current": times, "park": times}
    parquet.write_table(pa.table(table), folder / "d.parquet")
    for name in ("e.asc", "f.blf", "g.log", "h.trc"):
        with can.Logger(folder / name) as log:
            for k, time_s in enumerate(times.tolist()):
                log(can.Message(1.7e9 + time_s, 256 + k % 2, False, data=bytes([k, 0, 1, 2][: 4 - 3 * (k % 2)])))
    importlib.reload(can.io.mf4)  # hilplant hides asammdf while it imports python-can
    with can.Logger(folder / "i.mf4") as log:
        for k, time_s in enumerate(times.tolist()):
            log(can.Message(1.7e9 + time_s, 256, False, data=bytes([k, 0, 1, 2]), channel=0))
    return sorted(folder.iterdir())


def mutated(content: bytes, rng: random.Random) -> bytes:
    """Change, remove, repeat or insert a few pieces."""
    data = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 5, 20))):
        at = rng.randrange(len(data) + 1)
        size = rng.choice((1, 1, 2, 4, 30))
        kind = rng.randrange(6)
        if kind == 0:
            data[at : at + size] = rng.randbytes(size)
        elif kind == 1:
            del data[at : at + size]
        elif kind == 2:
            data[at:at] = data[at : at + size * 10]
        elif kind == 3:
            data[at:at] = rng.choice((b"\0", b"\xff", b"\n", b";", b",", b'"', b"1e999", b"nan", b"-", b"9" * 40))
        elif kind == 4:
            del data[at:]
        else:
            data[at : at + 4] = rng.choice((b"\0" * 4, b"\xff" * 4, b"\1\0\0\0", b"\xff\xff\xff\x7f"))
        if not data:
            break
    return bytes(data)


def _peak_kib() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def run(cases: int, seed: int, say: Callable[[str], None] = print) -> int:
    """Run that many cases; return how many ended in anything but channels or one line."""
    wrong = read = 0
    began = time.monotonic()
    before = _peak_kib()  # of what this process did before
    signal.signal(signal.SIGALRM, _too_long)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "good").mkdir()
        (folder / "rig.dbc").write_text(DBC)
        files = [(path.suffix, path.read_bytes()) for path in good_files(folder / "good")]
        for case in range(cases):
            rng = random.Random(seed * 1_000_003 + case)
            ending, content = rng.choices(files, [MF4_PART if path == ".mf4" else 1.0 for path, _ in files])[0]
            path = folder / f"x{ending}"
            path.write_bytes(mutated(content, rng))
            signal.alarm(LONGEST_S)
            try:
                read_channels(Origin(path, frames=FrameSource(folder / "rig.dbc")))
                read += 1
            except Failure as error:
                if "\n" in str(error):
                    wrong += 1
                    say(f"case {case} ({ending}): more than a line: {error}")
            except BaseException as error:
                wrong += 1
                say(f"case {case} ({ending}): {type(error).__name__}: {str(error)[:200]}")
            finally:
                signal.alarm(0)
    memory = _peak_kib() - before
    say(f"{cases} cases in {time.monotonic() - began:.0f} s: {read} read, {wrong} wrong; {memory // 1024} MiB")
    return wrong + (memory > MOST_KIB)


def _too_long(number: int, frame: FrameType | None) -> None:
    raise TimeoutError(f"longer than {LONGEST_S} s")


if __name__ == "__main__":
    raise SystemExit(bool(run(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)))
