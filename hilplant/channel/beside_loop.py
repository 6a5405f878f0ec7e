"""The door beside a loop: its process, and the file that says where it is, for as long as the loop runs."""

import os
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import asdict
from typing import Any

from hilplant.bench import Bench
from hilplant.channel.run_files import RunFile, run_folder
from hilplant.companion import Companion, begun
from hilplant.extras import missing
from hilplant.runtime.ring import Ring


@contextmanager
def announced(bench: Bench, ring: Ring, door: Companion | None) -> Iterator[RunFile]:
    """Say that the run is there; `door`, where there is one, is opened, and ended with the run.

    Raises
    ------
    Failure
        When the door cannot be opened.
    """
    interface = " ".join(str(value) for value in bench.interface.values())
    socket = str(run_folder() / f"{ring.name}.sock") if door is not None else ""
    run = RunFile(ring.name, os.getpid(), bench.name, interface, bench.step_ns, socket)
    try:
        if door is not None:
            order = {**asdict(run), "metadata": _metadata(bench), "loop_cpu": bench.loop.cpu}
            door.order(order, "the channel's process did not start; without it: --no-channel")
        run.write()
        yield run
    finally:
        if door is not None:
            door.end()
        run.remove()


def door_begun(wanted: bool = True) -> AbstractContextManager[Companion | None]:
    """Start the door's process, if it is wanted: it loads what it needs while the bench is read."""
    return begun("hilplant.channel.door") if wanted else nullcontext()


def _metadata(bench: Bench) -> dict[str, Any] | None:
    """Return what a recording that begins late says of the run; None where nothing can be recorded."""
    if missing("recording"):
        return None
    from hilplant.recording.recorder import description_now

    return description_now(bench)
