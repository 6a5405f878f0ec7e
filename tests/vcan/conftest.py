"""Fixtures of the tests that need a real SocketCAN interface; `start.py test` runs them with a private vcan0."""

import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from support.can_utils import HILPLANT, SOFT_TIME, START_PATIENCE_S, Commander

INTERFACE = "vcan0"
PATIENCE_S = 10.0
HERE = Path(__file__).parent


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if HERE in item.path.parents:
            item.add_marker(pytest.mark.vcan)
    items.sort(key=lambda item: "shared_server" in getattr(item, "fixturenames", ()))  # it stays until the end


def pytest_collection_finish(session: pytest.Session) -> None:
    """Compile what the daemon runs before any test's time counts: with nothing in the cache a guest takes minutes.

    With `HILPLANT_COMPILED` that is done.
    """
    compiled = session.config.option.collectonly or os.environ.get("HILPLANT_COMPILED")
    if not compiled and any(HERE in item.path.parents for item in session.items):
        words = [sys.executable, "-m", "hilplant", "run", "virtual", "--seconds", "0.1"]
        subprocess.run(words, capture_output=True, check=False)


@pytest.fixture
def vcan() -> Iterator[str]:
    """The name of the interface, up; it is set up again after the test."""
    names = [name for _, name in socket.if_nameindex()]
    assert INTERFACE in names, f"no {INTERFACE} here; run: python3 start.py test"
    yield INTERFACE
    subprocess.run(["ip", "link", "set", INTERFACE, "up"], check=True)


class Spawned:
    """A program that runs beside the test, with its output in a file."""

    def __init__(self, words: tuple[str, ...]) -> None:
        self.words = words
        self._output = tempfile.TemporaryFile()  # noqa: SIM115
        self.process = subprocess.Popen(
            words, stdin=subprocess.DEVNULL, stdout=self._output, stderr=subprocess.STDOUT, start_new_session=True
        )

    @property
    def output(self) -> str:
        return os.pread(self._output.fileno(), 2**26, 0).decode(errors="replace")

    def wait_for(self, text: str, patience_s: float = PATIENCE_S) -> None:
        """Return once `text` is in the output."""
        deadline = time.monotonic() + patience_s
        while text not in self.output:
            if self.process.poll() is not None and text not in self.output:
                pytest.fail(f"{self.words} ended with {self.process.returncode}, without {text!r}:\n{self.output}")
            if time.monotonic() > deadline:
                pytest.fail(f"{self.words} did not say {text!r} within {patience_s} s:\n{self.output}")
            time.sleep(0.02)

    def end(self, number: int = signal.SIGTERM, patience_s: float = PATIENCE_S) -> int:
        """Send a signal and return the exit code."""
        if self.process.poll() is None:
            self.process.send_signal(number)
        return self.process.wait(patience_s)

    def close(self) -> None:
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        self._output.close()


@contextmanager
def spawning() -> Iterator[Callable[..., Spawned]]:
    """Start programs; they are ended afterwards, and their output shown when a test failed."""
    started: list[Spawned] = []

    def start(*words: object) -> Spawned:
        started.append(Spawned(tuple(str(word) for word in words)))
        return started[-1]

    yield start
    for program in started:
        print(f"--- {' '.join(program.words)}\n{program.output[-4000:]}")
        program.close()


@pytest.fixture
def spawn() -> Iterator[Callable[..., Spawned]]:
    """Start a program; it is ended after the test."""
    with spawning() as start:
        yield start


class Candump:
    """The frames on the interface, as candump's log lines: `(seconds) vcan0 123#1122`."""

    def __init__(self, interface: str, *filters: str) -> None:
        self.lines: list[str] = []
        self._arrived = threading.Condition()
        words = ["stdbuf", "-oL", "candump", "-L", "-r", "4000000", ",".join((interface, *filters))]
        self._process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        self._thread = threading.Thread(target=self._collect, daemon=True)
        self._thread.start()

    def _collect(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            with self._arrived:
                self.lines.append(line.strip())
                self._arrived.notify_all()

    def wait_for(self, text: str, count: int = 1, patience_s: float = PATIENCE_S) -> list[str]:
        """Return the lines that contain `text` once there are `count` of them."""

        def found() -> list[str]:
            return [line for line in self.lines if text in line]

        with self._arrived:
            self._arrived.wait_for(lambda: len(found()) >= count, patience_s)
        assert len(found()) >= count, f"{len(found())} of {count} lines with {text!r}; last: {self.lines[-5:]}"
        return found()

    def close(self) -> None:
        self._process.terminate()
        self._process.wait()
        self._thread.join()


def listening(interface: str, *filters: str, mark: str = "7FF#") -> Candump:
    """Start candump and return once it listens, which it does not say: marks are sent until one is seen."""
    listener = Candump(interface, *filters)
    deadline = time.monotonic() + PATIENCE_S
    while not listener.lines and time.monotonic() < deadline:
        subprocess.run(["cansend", interface, mark], check=True)
        time.sleep(0.02)
    time.sleep(0.1)
    listener.lines.clear()
    return listener


@pytest.fixture
def candump(vcan: str) -> Iterator[Candump]:
    """Everything that is sent on the interface from here on."""
    listener = listening(vcan)
    yield listener
    listener.close()


@pytest.fixture
def plant_frames(vcan: str) -> Iterator[Candump]:
    """What the plant sends from here on, 0x200 to 0x21F, and nothing else."""
    listener = listening(vcan, "200:7E0", mark="21F#")
    yield listener
    listener.close()


@pytest.fixture
def ecu_frames(vcan: str) -> Iterator[Candump]:
    """What the ECU sends from here on, and of the plant the park switch and the linkage."""
    filters = ("120:7FF", "130:7FF", "201:7FF", "202:7FF")
    listener = listening(vcan, *filters, mark="202#0000000000000000")
    yield listener
    listener.close()


@pytest.fixture
def cansend(vcan: str) -> Callable[[str], None]:
    """Send one frame, written as for cansend: `123#1122`, FD `123##0112233`, remote `123#R`."""

    def send(frame: str) -> None:
        subprocess.run(["cansend", vcan, frame], check=True)

    return send


@pytest.fixture
def commander(vcan: str) -> Iterator[Commander]:
    running = Commander(vcan)
    yield running
    running.stop()


@pytest.fixture
def server(spawn: Callable[..., Any], vcan: str, tmp_path: Path) -> Any:
    """The daemon on the default bench, recording; it has sent its first frames."""
    daemon = spawn(*HILPLANT, "run", SOFT_TIME, "--record", tmp_path / "run.hilrec")
    daemon.wait_for("serves on", START_PATIENCE_S)
    return daemon


@pytest.fixture(scope="session")
def shared_server() -> Iterator[Spawned]:
    """The daemon on the default bench for all tests that leave it running: a start takes a guest long."""
    with spawning() as start:
        daemon = start(*HILPLANT, "run", SOFT_TIME)
        daemon.wait_for("serves on", START_PATIENCE_S)
        yield daemon
        assert daemon.end(patience_s=PATIENCE_S) == 0
