"""From the start of `hilplant run` to its first tick, with an empty and a filled cache of compiled code."""

import json
import subprocess
import sys
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from hilplant.perf.daemon_run import run_daemon_once, virtual_bench
from hilplant.perf.results import Goal, NotMeasurable, PartResult, Row

_ROUNDS = 3
_ONE_TICK_S = 0.001
#: What no start can do without: the interpreter and the libraries.
_LIBRARIES = "import can, cantools, numba, numpy, pydantic, typer, yaml"
_SPLIT = """
import json, sys, time
begin = time.perf_counter()
import hilplant.cli.main, hilplant.cli.actions.run
imported = time.perf_counter()
from hilplant.bench import load_bench
bench = load_bench(sys.argv[1])
loaded = time.perf_counter()
from hilplant.bus.transport import open_transport
from hilplant.runtime.clock import WallClock
from hilplant.runtime.server import build_loop
loop = build_loop(bench, open_transport(bench.interface), WallClock())
loop.warm_up()
warm = time.perf_counter()
from hilplant.runtime.scheduling import real_time
with real_time(bench.loop.priority, bench.loop.cpu):
    ready = time.perf_counter()
print(json.dumps([imported - begin, loaded - imported, warm - loaded, ready - warm]))
"""
#: asammdf, where it is installed, is not among them: python-can would import it for a logger that is not used.
_LEAN = "import sys, time; sys.modules['asammdf'] = None; begin = time.perf_counter()"
_TIMED = f"{_LEAN}; {_LIBRARIES}; print(time.perf_counter() - begin)"


def measure() -> PartResult:
    """Measure one cold start and a few warm ones, and where the time of a warm one goes."""
    with virtual_bench() as bench, TemporaryDirectory(prefix="hilplant-cold-") as cache:
        cold_s = run_daemon_once(bench, _ONE_TICK_S, Path(cache)).first_tick_s
        warm_s = median(run_daemon_once(bench, _ONE_TICK_S, Path(cache)).first_tick_s for _ in range(_ROUNDS))
        rounds = [json.loads(_python(_SPLIT, str(bench))) for _ in range(_ROUNDS)]
    imports_s, bench_s, loop_s, privileges_s = (median(values) for values in zip(*rounds, strict=True))
    libraries_s = median(float(_python(_TIMED)) for _ in range(_ROUNDS))
    rows = [
        Row("start to first tick, warm", warm_s, "s", libraries_s, "libraries", Goal(3.0, of_ratio=False)),
        Row("  of it imports", imports_s, "s", libraries_s, "libraries"),
        Row("  of it bench and tables", bench_s, "s"),
        Row("  of it the loop, warmed up", loop_s, "s"),
        Row("  of it memory locked", privileges_s, "s"),
        Row("start to first tick, cold", cold_s, "s", warm_s, "warm"),
    ]
    figures: dict[str, float | str] = {
        "startup_warm_s": warm_s,
        "startup_cold_s": cold_s,
        "startup_imports_s": imports_s,
        "startup_bench_s": bench_s,
        "startup_loop_s": loop_s,
        "startup_privileges_s": privileges_s,
        "startup_libraries_s": libraries_s,
    }
    remark = f"cold: nothing compiled yet, files in the page cache; libraries: {_LIBRARIES}"
    return PartResult(rows, figures, [remark])


def _python(code: str, *arguments: str) -> str:
    command = [sys.executable, "-c", code, *arguments]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    if ended.returncode:
        raise NotMeasurable((ended.stderr.strip() or "no message").splitlines()[-1])
    return ended.stdout
