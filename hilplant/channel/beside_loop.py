"""The door beside a loop: its process, and the file that says where it is, for as long as the loop runs."""

import contextlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from typing import Any

from hilplant.bench import Bench
from hilplant.channel.run_files import RunFile, run_folder
from hilplant.companion import companion
from hilplant.extras import missing
from hilplant.runtime.ring import Ring


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
    otherwise = "the channel's process did not start; without it: --no-channel"
    with companion("hilplant.channel.door", order, otherwise):
        yield


def _metadata(bench: Bench) -> dict[str, Any] | None:
    """Return what a recording that begins late says of the run; None where nothing can be recorded."""
    if missing("recording"):
        return None
    from hilplant.recording.recorder import description_now

    return description_now(bench)
