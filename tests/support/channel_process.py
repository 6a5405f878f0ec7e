"""A run as a process of its own, and what a test waits for there."""

import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from hilplant.channel.run_files import run_named
from hilplant.failure import Failure
from hilplant.runtime.follower import Follower


@contextmanager
def going_on(channel: str, *options: str) -> Iterator[subprocess.Popen[bytes]]:
    command = [sys.executable, "-m", "hilplant", "run", "virtual", "--channel", channel, *options]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    wait_until(lambda: process.poll() is not None or _ticks(channel))
    assert process.poll() is None, process.stdout and process.stdout.read()
    yield process
    if process.poll() is None:
        process.terminate()
        process.wait(60)


def _ticks(channel: str) -> bool:
    try:
        follower = Follower(run_named(channel).ring)
    except (Failure, OSError, ValueError):
        return False
    there = follower.latest()[0] > 0
    follower.close()
    return bool(there)


def wait_until(what: object) -> None:
    pause = threading.Event()
    for _ in range(6000):
        if what():  # type: ignore[operator]
            return
        pause.wait(0.02)
    raise AssertionError("it did not come to pass in two minutes")
