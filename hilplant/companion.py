"""A process beside this one: started with one line, ready with one line, and ended with the pipe that it was given."""

import contextlib
import json
import select
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

from hilplant.failure import Failure

_TIMEOUT_S = 30.0
#: First word of the line with which such a process says that it is ready.
READY = "ready"


class Companion(NamedTuple):
    """A process that is ready: what it said behind ``ready``, and itself."""

    said: str
    child: "subprocess.Popen[bytes]"


@contextmanager
def companion(module: str, order: dict[str, Any], otherwise: str) -> Iterator[Companion]:
    """Run the module `module` with `order` as a line of JSON on its standard input, until the block ends.

    The end of its input tells it to end. `otherwise` is the failure where it does not say anything.

    Raises
    ------
    Failure
        With what it said, when that is not ``ready``.
    """
    command = [sys.executable, "-m", module]
    child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True)
    if child.stdin is None or child.stdout is None:
        raise AssertionError("a companion is always started with pipes")
    try:
        with contextlib.suppress(BrokenPipeError):
            child.stdin.write(json.dumps(order).encode() + b"\n")
            child.stdin.flush()
        answering, _, _ = select.select([child.stdout], [], [], _TIMEOUT_S)
        answer = child.stdout.readline().decode().strip() if answering else ""
        word, _, said = answer.partition(" ")
        if word != READY:
            raise Failure(answer or otherwise)
        yield Companion(said, child)
    finally:
        with contextlib.suppress(OSError):
            child.stdin.close()
        try:
            child.wait(_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()
        child.stdout.close()
