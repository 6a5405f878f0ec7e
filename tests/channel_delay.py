"""How many ticks begin between sending a command through the channel and its being applied, on the wall clock.

::

    PYTHONPATH=. python tests/channel_delay.py [COMMANDS]
"""

import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

import hilplant
from hilplant.channel.client import RunChannel
from hilplant.failure import Failure
from hilplant.runtime.follower import Follower

_TICK, _DEADLINE = 0, 1
_START_S, _PAUSE_S = 120.0, 0.02
_NAME = f"delay-{os.getpid()}"


@contextmanager
def running() -> Iterator[RunChannel]:
    """Start a run of the default bench; yield its channel once it ticks."""
    process = subprocess.Popen([sys.executable, "-m", "hilplant", "run", "virtual", "--channel", _NAME])
    until = time.monotonic() + _START_S
    try:
        while True:
            try:
                with hilplant.connect(_NAME) as channel:
                    yield channel
                    return
            except Failure:
                if process.poll() is not None or time.monotonic() > until:
                    raise
                threading.Event().wait(0.2)
    finally:
        process.terminate()
        process.wait(30)


def clock_of(ring: Follower) -> float:
    """Return the monotonic clock at the run's first deadline [ns], late by what a row needs until it is seen."""
    until, found = time.monotonic() + 1.0, np.inf
    while time.monotonic() < until:
        found = min(found, time.monotonic_ns() - ring.latest()[_DEADLINE])
    return found


def main() -> None:
    """Measure, and print."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    with running() as channel:
        ring = Follower(channel.run.ring)
        threading.Event().wait(2.0)
        began_ns = clock_of(ring)
        ring.rows()
        sent, applied, parts = [], [], []
        for index in range(count):
            sent.append(time.monotonic_ns())
            applied.append(channel.set("supply_v", 12.0 + 1e-3 * index))
            parts.append(ring.rows().records.copy())
            threading.Event().wait(_PAUSE_S)
        ring.close()
    rows = np.concatenate(parts)
    begun = began_ns + rows[:, _DEADLINE]
    ticks = [np.count_nonzero((rows[:, _TICK] <= at) & (begun > ns)) for at, ns in zip(applied, sent, strict=True)]
    share = ", ".join(f"{np.mean(np.array(ticks) <= most):.1%} within {most}" for most in (1, 2, 3))
    lost = np.count_nonzero(np.diff(rows[:, _DEADLINE]) > 1.5 * np.min(np.diff(rows[:, _DEADLINE])))
    print(f"{count} commands: {share}; at most {max(ticks)} ticks; the loop was late by a tick or more {lost} times")


if __name__ == "__main__":
    main()
