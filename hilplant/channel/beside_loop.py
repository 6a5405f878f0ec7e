"""The door beside a loop: its process, and the file that says where it is, for as long as the loop runs."""

import contextlib
import json
import os
import select
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from typing import Any

from hilplant.bench import Bench
from hilplant.channel.run_files import RunFile, run_folder
from hilplant.extras import missing
from hilplant.failure import Failure
from hilplant.runtime.ring import Ring

_START_TIMEOUT_S = 30.0


@contextmanager
def announced(bench: Bench, ring: Ring, channel: bool = True) -> Iterator[RunFile]:
    """Say that the run is there; with `channel` open a door to it.

    Raises
    ------
    Failure
        When the door cannot be opened.
    """
    interface = " ".join(str(value) for value in bench.interface.values())
    socket = str(run_folder() / f"{ring.name}.sock") if channel else ""
    run = RunFile(ring.name, os.getpid(), bench.name, interface, bench.step_ns, socket)
    try:
        with _door(bench, run) if channel else contextlib.nullcontext():
            run.write()
            yield run
    finally:
        run.remove()


@contextmanager
def _door(bench: Bench, run: RunFile) -> Iterator[None]:
    order = {**asdict(run), "metadata": _metadata(bench), "loop_cpu": bench.loop.cpu}
    child = subprocess.Popen(
        [sys.executable, "-m", "hilplant.channel.door"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        start_new_session=True,
    )
    if child.stdin is None or child.stdout is None:
        raise AssertionError("the door is always started with pipes")
    try:
        with contextlib.suppress(BrokenPipeError):
            child.stdin.write(json.dumps(order).encode() + b"\n")
            child.stdin.flush()
        ready, _, _ = select.select([child.stdout], [], [], _START_TIMEOUT_S)
        answer = child.stdout.readline().decode().strip() if ready else ""
        if answer != "ready":
            raise Failure(answer or "the channel's process did not start; without it: --no-channel")
        yield
    finally:
        with contextlib.suppress(OSError):
            child.stdin.close()
        try:
            child.wait(_START_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()
        child.stdout.close()


def _metadata(bench: Bench) -> dict[str, Any] | None:
    """Return what a recording that begins late says of the run; None where nothing can be recorded."""
    if missing("recording"):
        return None
    from hilplant.recording.recorder import description_now

    return description_now(bench)
