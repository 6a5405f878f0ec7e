"""How late the daemon's loop is woken, against cyclictest with the same policy, priority and processor.

Both measure from the deadline to the first instruction after the sleep, in whole microseconds. They run in
turn, several times; each figure is the median over the rounds, the worst case the worst of all rounds.
"""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hilplant.perf.cyclictest import Latencies, run_cyclictest
from hilplant.perf.daemon_run import PRIORITY, chosen_cpu, run_daemon_once, virtual_bench
from hilplant.perf.results import Goal, NotMeasurable, PartResult, Row
from hilplant.perf.samples import middle

_ROUNDS = 3
_SECONDS = 4.0
_GOAL = Goal(1.5)


@contextmanager
def busy_cores() -> Iterator[None]:
    """Keep every processor busy with an ordinary process."""
    command = [sys.executable, "-c", "while True: pass"]
    busy = [subprocess.Popen(command) for _ in range(os.cpu_count() or 1)]
    try:
        yield
    finally:
        for load in busy:
            load.kill()
            load.wait()


def measure() -> PartResult:
    """Measure on the machine as it is, then with every processor busy."""
    measured = PartResult()
    with virtual_bench() as bench:
        run_daemon_once(bench, 0.01)
        _compare(bench, measured, "", "")
        with busy_cores():
            _compare(bench, measured, "_loaded", ", all cores busy")
    how = f"SCHED_FIFO {PRIORITY} on CPU {chosen_cpu()}, alternately {_ROUNDS} x {_SECONDS:g} s each"
    measured.remarks.append(f"{how}; the median of the rounds, of max the greatest")
    return measured


def _compare(bench: Path, measured: PartResult, suffix: str, condition: str) -> None:
    loops, cyclictests = [], []
    for _ in range(_ROUNDS):
        loops.append(_of_daemon(bench)._asdict())
        cyclictests.append(run_cyclictest(PRIORITY, chosen_cpu(), _SECONDS)._asdict())
    ours, floor = middle(loops), middle(cyclictests)
    for name, value in ours.items():
        quantity = name.removesuffix("_us")
        what = f"late, {quantity.replace('p999', 'p99.9')}{condition}"
        goal = _GOAL if quantity == "p99" else None
        measured.rows.append(Row(what, value, "us", floor[name], "cyclictest", goal))
        measured.figures[f"wakeup{suffix}_{quantity}_us"] = value
        measured.figures[f"wakeup{suffix}_{quantity}_ratio_to_cyclictest"] = value / floor[name]
        measured.figures[f"cyclictest{suffix}_{quantity}_us"] = floor[name]


def _of_daemon(bench: Path) -> Latencies:
    run = run_daemon_once(bench, _SECONDS)
    fix = run.missing("SCHED_FIFO")
    if fix is not None:
        raise NotMeasurable(f"the loop was refused SCHED_FIFO: {fix}")
    names = ("p50_us", "p99_us", "p999_us", "max_us")
    return Latencies(*(float(run.summary[f"latency_{name}"]) for name in names))
