"""A process beside this one: started with one line, ready with one line, and ended with the pipe that it was given."""

import contextlib
import json
import select
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from hilplant.failure import Failure

_TIMEOUT_S = 30.0
#: First word of the line with which such a process says that it is ready.
READY = "ready"


class Companion:
    """A process that loads what it needs, waits for its order, and is ready after that."""

    def __init__(self, module: str) -> None:
        """Start the module `module`."""
        command = [sys.executable, "-m", module]
        self.child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True)
        if self.child.stdin is None or self.child.stdout is None:
            raise AssertionError("a companion is always started with pipes")
        self._stdin, self._stdout, self._ordered = self.child.stdin, self.child.stdout, False
        #: What it said behind ``ready``.
        self.said = ""

    def order(self, order: dict[str, Any], otherwise: str) -> None:
        """Give it its order as a line of JSON, and return when it is ready.

        `otherwise` is the failure where it does not say anything.

        Raises
        ------
        Failure
            With what it said, when that is not ``ready``.
        """
        self._ordered = True
        with contextlib.suppress(BrokenPipeError):
            self._stdin.write(json.dumps(order).encode() + b"\n")
            self._stdin.flush()
        answering, _, _ = select.select([self._stdout], [], [], _TIMEOUT_S)
        answer = self._stdout.readline().decode().strip() if answering else ""
        word, _, self.said = answer.partition(" ")
        if word != READY:
            raise Failure(answer or otherwise)

    def end(self) -> None:
        """Tell it to end, by the end of its input, and wait for that; one without an order has nothing to end."""
        if not self._ordered:
            self.child.kill()
        with contextlib.suppress(OSError):
            self._stdin.close()
        try:
            self.child.wait(_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            self.child.kill()
            self.child.wait()
        self._stdout.close()


@contextmanager
def begun(module: str) -> Iterator[Companion]:
    """Run the module `module` until the block ends; it waits for its order."""
    started = Companion(module)
    try:
        yield started
    finally:
        started.end()


@contextmanager
def companion(module: str, order: dict[str, Any], otherwise: str) -> Iterator[Companion]:
    """Run the module `module` until the block ends, ordered and ready; Failure as in :meth:`Companion.order`."""
    with begun(module) as started:
        started.order(order, otherwise)
        yield started
