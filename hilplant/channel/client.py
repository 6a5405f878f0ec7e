"""A run as a Python program sees it: read its signals, and take part in it."""

import contextlib
import json
import socket
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from hilplant.arrays import Floats
from hilplant.channel.requests import LEASE_S
from hilplant.channel.run_files import RunFile, column_of, columns, run_named
from hilplant.failure import Failure
from hilplant.faults.written import FaultEntry, entry_named
from hilplant.runtime.follower import Follower

_ALIVE_EVERY_S = LEASE_S / 4
_TIMEOUT_S = 30.0


def connect(name: str | None = None) -> "RunChannel":
    """Open the channel of a run: by its socket, its CAN channel or its bench; without a name of the only run.

    Raises
    ------
    Failure
        When there is no such run, more than one, or it has no channel.
    """
    run = run_named(name)
    if not run.socket:
        raise Failure(f"{run.bench} on {run.interface} was started with --no-channel")
    return RunChannel(run)


class RunChannel:
    """A channel into a running loop. Each command returns the tick at which it was applied.

    What it holds by :meth:`override` and :meth:`fault` is released when it is closed, and 1 s after it was killed.
    """

    def __init__(self, run: RunFile) -> None:
        """Connect to a run."""
        self.run = run
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._socket.settimeout(_TIMEOUT_S)
        try:
            self._socket.connect(run.socket)
        except OSError as error:
            raise Failure(f"{run.socket}: the channel does not answer: {error.strerror or error}") from error
        self._lines = self._socket.makefile("rb")
        self._sending, self._asking = threading.Lock(), threading.Lock()
        self._number, self._closed = 0, threading.Event()
        self._held: set[str] = set()
        self._leased = False  # whether faults may be held
        #: What the run has told without being asked, such as inputs that were released.
        self.events: list[dict[str, Any]] = []
        self._follower = Follower(run.ring)
        self.hello = self.ask("hello", protocol=run.protocol)
        threading.Thread(target=self._live, daemon=True, name="hilplant channel").start()

    def set(self, name: str | Mapping[str, Any], value: Any = None) -> int:
        """Set an input, or several in one tick: until a frame of the bus carries another value."""
        return self._tick("set", values=_values(name, value))

    def override(self, name: str | Mapping[str, Any], value: Any = None, lease_s: float = LEASE_S) -> int:
        """Hold an input, or several in one tick, against bus and scenario until it is released."""
        values = _values(name, value)
        tick = self._tick("override", values=values, lease_s=lease_s)
        self._held.update(values)
        return tick

    def release(self, *names: str) -> int:
        """Let go of inputs; of all that are held when none is named."""
        wanted = list(names) or sorted(self._held)
        tick = self._tick("release", names=wanted)
        self._held.difference_update(wanted)
        return tick

    def parameter(self, name: str | Mapping[str, float], value: float | None = None) -> int:
        """Change an element of the plant's parameters, or several in one tick, such as ``wiring.altered``."""
        return self._tick("parameter", values=_values(name, value))

    def fault(self, name: str, /, lease_s: float = LEASE_S, **keys: Any) -> int:
        """Insert a fault until it is cleared; the keys are its quantities and those of a scenario's `faults`.

        ``fault("resistance_53", resistance_ohm=0.5, for_=2.0)``; `for_` stands for `for`, and `at` counts from now. The
        same fault about the same message takes the place of the one before. `hilplant faults` lists all.
        """
        return self.insert(entry_named(name, keys), lease_s)

    def insert(self, entry: FaultEntry, lease_s: float = LEASE_S) -> int:
        """Insert a fault as :meth:`fault` does."""
        tick = self._tick("fault", lease_s=lease_s, **entry.model_dump(by_alias=True, exclude_defaults=True))
        self._leased = True
        return tick

    def clear(self, *names: str) -> int:
        """End the faults of these names that this client has inserted; all of them when none is named."""
        return self._tick("clear", names=list(names))

    def reference(self, value: float) -> int:
        """Give the controller inside the loop another wanted speed of the crank [rad/s]."""
        return self._tick("reference", value=value)

    def mark(self, text: str) -> int:
        """Put a mark into the recording: up to 80 bytes."""
        return self._tick("mark", text=text)

    def record(self, path: str | Path) -> int:
        """Begin to record into this new file; returns a tick that it holds."""
        return self._tick("record", path=str(Path(path).absolute()))

    def stop_recording(self) -> int:
        """End the recording; it is whole when this returns."""
        return self._tick("record_stop")

    def status(self) -> dict[str, Any]:
        """Return tick, counts, who commands each input, and the faults that are there."""
        return self.ask("status")

    def latest(self) -> dict[str, float]:
        """Return the newest row by the names of its columns, and each output and input by its own name too."""
        row = self._follower.latest()
        full = {name: float(value) for (name, _), value in zip(columns(), row, strict=True)}
        short = {name.partition(".")[2]: full[name] for name in reversed(full) if name.startswith(("in.", "out."))}
        return full | short

    def rows(self, names: Sequence[str]) -> tuple[Floats, int]:
        """Return these signals in all ticks since the last call, float64 [ticks, signals], and how many were lost."""
        taken = self._follower.rows()
        return taken.records[:, [column_of(name) for name in names]], taken.lost

    def ask(self, wanted: str, **more: Any) -> dict[str, Any]:
        """Send a request of the protocol and return its answer.

        Raises
        ------
        Failure
            When it is refused, or the run has ended.
        """
        with self._asking:
            self._number += 1
            self._send({"id": self._number, "do": wanted, **more})
            while True:
                answer = self._receive()
                if answer.get("id") == self._number:
                    break
                self.events.append(answer)
        if not answer.get("ok"):
            raise Failure(str(answer.get("error", "refused")))
        return answer

    def close(self) -> None:
        """Release what is held, and disconnect."""
        if self._closed.is_set():
            return
        with contextlib.suppress(Failure):
            if self._held:
                self.release()
            if self._leased:
                self.clear()
        self._closed.set()
        self._lines.close()
        self._socket.close()
        self._follower.close()

    def __enter__(self) -> "RunChannel":
        """Return the channel."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        self.close()

    def _tick(self, wanted: str, **more: Any) -> int:
        return int(self.ask(wanted, **more)["tick"])

    def _send(self, request: dict[str, Any]) -> None:
        with self._sending:
            try:
                self._socket.sendall(json.dumps(request).encode() + b"\n")
            except OSError as error:
                raise Failure(f"{self.run.socket}: the channel is closed") from error

    def _receive(self) -> dict[str, Any]:
        try:
            line = self._lines.readline()
        except OSError as error:
            raise Failure(f"{self.run.socket}: the channel does not answer") from error
        if not line:
            raise Failure(f"{self.run.socket}: the run has ended")
        answer: dict[str, Any] = json.loads(line)
        return answer

    def _live(self) -> None:
        """Say that this client lives, for its leases."""
        while not self._closed.wait(_ALIVE_EVERY_S):
            if self._held or self._leased:
                try:
                    self._send({"do": "alive"})
                except Failure:
                    return


def _values(name: str | Mapping[str, Any], value: Any) -> dict[str, Any]:
    return {name: value} if isinstance(name, str) else dict(name)
