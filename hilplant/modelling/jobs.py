"""One piece of long work at a time, in a process of its own: started, watched, stopped."""

import contextlib
import json
import signal
import subprocess
import sys
import tempfile
import threading
from dataclasses import asdict, dataclass, field
from typing import Any

from hilplant.failure import Failure

#: How long a stopped job may take to end of itself [s].
_END_S = 10.0


@dataclass(slots=True)
class JobState:
    """Where a job stands: running, done, failed, stopped; what it last said, and what it found."""

    work: str = ""
    state: str = "none"
    progress: dict[str, Any] = field(default_factory=dict)
    answer: Any = None
    text: str = ""


class Jobs:
    """The one job that runs, or the last one that ran."""

    def __init__(self) -> None:
        self._state = JobState()
        self._child: subprocess.Popen[str] | None = None
        self._reader: threading.Thread | None = None
        self._lock = threading.Lock()

    @property
    def state(self) -> dict[str, Any]:
        """What the page shows of it."""
        with self._lock:
            return asdict(self._state)

    def start(self, work: str, order: dict[str, Any]) -> None:
        """Start a job.

        Raises
        ------
        Failure
            While another one runs.

        """
        with self._lock:
            if self._state.state == "running":
                raise Failure(f"{self._state.work} is running; stop it first")
            complaints = tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace")  # noqa: SIM115
            child = subprocess.Popen(
                [sys.executable, "-m", "hilplant.modelling.job_process"],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=complaints, text=True, start_new_session=True,
            )  # fmt: skip
            state = JobState(work, "running")
            self._child, self._state = child, state
        if child.stdin is None or child.stdout is None:
            raise AssertionError("a job is always started with pipes")
        with contextlib.suppress(BrokenPipeError):
            child.stdin.write(json.dumps(order | {"work": work}) + "\n")
            child.stdin.close()
        self._reader = threading.Thread(target=self._read, args=(child, complaints, state), daemon=True)
        self._reader.start()

    def stop(self) -> None:
        """Stop the job that runs; a training keeps the best so far, an identification can be resumed."""
        child = self._child
        if child is None or child.poll() is not None:
            return
        child.send_signal(signal.SIGINT)
        try:
            child.wait(_END_S)
        except subprocess.TimeoutExpired:
            child.kill()
        if self._reader is not None:
            self._reader.join(_END_S)

    def _read(self, child: "subprocess.Popen[str]", complaints: Any, state: JobState) -> None:
        """Follow one job to its end; the next one may have begun when this one's process is gone."""
        for line in child.stdout or ():
            with contextlib.suppress(ValueError):
                self._take(state, json.loads(line))
        code = child.wait()
        complaints.seek(0)
        last = complaints.read().strip().splitlines()[-1:]
        complaints.close()
        with self._lock:
            if state.state == "running":
                state.state = "stopped" if code < 0 else "failed"
                state.text = last[0] if last and code >= 0 else f"ended with {code}"

    def _take(self, state: JobState, said: dict[str, Any]) -> None:
        with self._lock:
            if said["kind"] == "progress":
                state.progress = said["content"]
            elif said["kind"] == "done":
                state.state, state.answer = "done", said["content"]
            else:
                state.state, state.text = said["kind"], said["content"]
