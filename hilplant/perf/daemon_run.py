"""Starts `hilplant run` as a user would, in a process of its own, on a bus that needs no hardware."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from hilplant.perf.results import NotMeasurable
from hilplant.units import SECOND_NS

_BENCH = """\
name: perf
extends: benches/default.yaml
bus: {{interface: {{interface: virtual, channel: perf}}}}
loop: {{cpu: {cpu}, priority: {priority}}}
"""

PRIORITY = 80


@dataclass(frozen=True, slots=True)
class DaemonRun:
    """What a run wrote to its JSON file, and how long it took to its first tick [s]."""

    summary: dict[str, Any]
    first_tick_s: float

    def missing(self, name: str) -> str | None:
        """Return why the privilege that starts with `name` was not given, None when it was."""
        for privilege in str(self.summary["privileges_missing"]).split(" | "):
            if privilege.startswith(name):
                return privilege.partition(": ")[2]
        return None


def chosen_cpu() -> int:
    """Return the last processor that this process may use; the first serves most interrupts."""
    return max(os.sched_getaffinity(0))


@contextmanager
def virtual_bench() -> Iterator[Path]:
    """Give the default bench on python-can's in-memory bus, pinned to one processor."""
    with TemporaryDirectory(prefix="hilplant-perf-") as folder:
        path = Path(folder) / "perf.yaml"
        path.write_text(_BENCH.format(cpu=chosen_cpu(), priority=PRIORITY), encoding="utf-8")
        yield path


def run_daemon_once(bench: Path, seconds: float, cache: Path | None = None) -> DaemonRun:
    """Run it to its end; `cache` is the folder of compiled code when not the usual one."""
    result = bench.with_suffix(".json")
    environment = dict(os.environ) if cache is None else {**os.environ, "NUMBA_CACHE_DIR": str(cache)}
    command = [sys.executable, "-m", "hilplant", "run", str(bench), "--seconds", str(seconds)]
    started_ns = time.monotonic_ns()
    command += ["--json", str(result)]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if ended.returncode:
        said = (ended.stderr.strip() or "no message").splitlines()[-1]
        raise NotMeasurable(f"hilplant run ended with {ended.returncode}: {said}")
    summary = json.loads(result.read_text(encoding="utf-8"))
    return DaemonRun(summary, (summary["first_tick_monotonic_ns"] - started_ns) / SECOND_NS)
