"""Lines for a reader who may be slow, or gone: the program never waits, and says how many were not shown."""

import contextlib
import os
import subprocess
import sys

import pytest

SAYS = """
import sys

import pytest
from hilplant.cli.voice import Voice
voice = Voice()
for number in range(20_000):
    voice.say(f"line {number}")
print("all said", file=sys.stderr, flush=True)
sys.stdin.readline()
voice.say("the end")
"""


def test_a_reader_that_does_not_read_holds_nothing_up_and_learns_how_much_it_missed() -> None:
    child = subprocess.Popen(
        [sys.executable, "-c", SAYS], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert child.stdin is not None
    assert child.stdout is not None
    assert child.stderr is not None
    assert child.stderr.readline() == b"all said\n"
    early = os.read(child.stdout.fileno(), 1 << 16)
    child.stdin.write(b"\n")
    told = early + child.communicate(timeout=60)[0]
    lines = told.decode().splitlines()
    assert lines[0] == "line 0"
    assert lines[-1] == "the end"
    shown = sum(line.startswith("line") for line in lines)
    unshown = [int(line.split()[0][1:]) for line in lines if line.startswith("(")]
    assert shown + sum(unshown) == 20_000
    assert sum(unshown) > 0


def test_a_reader_that_has_gone_is_no_error() -> None:
    child = subprocess.Popen(
        [sys.executable, "-c", SAYS], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert child.stdout is not None
    child.stdout.close()
    assert child.stdin is not None
    child.stdin.write(b"\n")
    child.stdin.close()
    assert child.stderr is not None
    assert child.stderr.read() == b"all said\n"
    assert child.wait(60) == 0


@pytest.mark.parametrize("command", ["control", "ecu"])
def test_a_node_on_the_bus_ends_in_time_though_nobody_reads_what_it_says(command: str) -> None:
    """The pipe is full before the first line, so that whoever waits for its reader never ends."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writer, bytes(4096))
    os.set_blocking(writer, True)
    arguments = [sys.executable, "-m", "hilplant", command, "virtual", "--seconds", "1.5"]
    arguments += ["--stalk", "0:slow"] if command == "ecu" else []
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    try:
        done = subprocess.run(
            arguments,
            stdin=subprocess.DEVNULL,
            stdout=writer,
            stderr=subprocess.PIPE,
            env=environment,
            timeout=60,
            check=False,
        )
    finally:
        os.close(reader)
        os.close(writer)
    assert done.returncode == 0, done.stderr.decode()
