"""Lines for those who watch a program that must not wait: what nobody reads is left out, and said later."""

import os
import select
import sys
from typing import TextIO

import typer


class Voice:
    """Prints lines without ever waiting for a reader, and goes on when there is none any more."""

    def __init__(self) -> None:
        self._unread = 0

    def say(self, text: str, err: bool = False) -> None:
        """Print a line, unless it could not be written at once."""
        stream = sys.stderr if err else sys.stdout
        descriptor = _descriptor(stream)
        if descriptor is None:
            typer.echo(text, err=err)
            return
        missed = f"({self._unread} lines were not shown: nobody read them)\n" if self._unread else ""
        if _write(descriptor, f"{missed}{text}\n"):
            self._unread = 0
        else:
            self._unread += 1


def _descriptor(stream: TextIO | None) -> int | None:
    try:
        return None if stream is None else stream.fileno()
    except (OSError, ValueError):  # a stand-in without a file behind it
        return None


def _write(descriptor: int, text: str) -> bool:
    """Write a text that fits what a pipe takes as a whole; return whether it was."""
    waiting = select.poll()
    waiting.register(descriptor, select.POLLOUT)
    try:
        ready = waiting.poll(0)
        if not ready or not ready[0][1] & select.POLLOUT:
            return False
        data = text.encode(errors="replace")[: select.PIPE_BUF]
        return os.write(descriptor, data) == len(data)
    except OSError:  # the reader has gone
        return False
