"""The daemon's handle on its recorder, a process of its own that drains the ring into a file."""

import contextlib
import json
import logging
import re
import select
import subprocess
import sys
import threading
from dataclasses import asdict, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import IO

from hilplant.failure import Failure
from hilplant.recording.metadata import describe
from hilplant.recording.recorded_bench import RecordedBench
from hilplant.recording.rotation import Rotation, parts_of
from hilplant.runtime.ring import Ring

_LOG = logging.getLogger(__name__)
#: A disk or a machine that is slow takes its time for the recorder's libraries; no loop waits yet.
_START_TIMEOUT_S = 90.0
#: Files that `export` makes of a recording; a recording under such a name would pass for one.
_EXPORTED = (".mf4", ".blf", ".asc", ".csv", ".parquet", ".mcap")


class Recorder:
    """A recorder at work. If it dies too early, one line on standard error says so and the run goes on."""

    def __init__(self, child: subprocess.Popen[bytes], ring: Ring, path: Path, lost_before: int) -> None:
        """Watch over `child` from a thread that sleeps until it ends; `lost_before`: what the ring had lost by then."""
        self._child = child
        self._ring = ring
        self._path = path
        self._ending = False
        self._lost_before = lost_before
        self._watch = threading.Thread(target=self._wait, daemon=True, name="recorder watch")
        self._watch.start()

    @property
    def path(self) -> Path:
        """The file, or the name of its parts."""
        return self._path

    @property
    def pid(self) -> int:
        """The recorder's number among the processes."""
        return self._child.pid

    def alive(self) -> bool:
        """Say whether the recorder still records."""
        return self._watch.is_alive()

    def finish(self, timeout: float = 30.0) -> None:
        """Wait until everything that is in the ring now is in the file.

        Raises
        ------
        Failure
            When the recorder had died, or does not come to an end in `timeout` seconds.
        """
        self._ending = True
        with contextlib.suppress(OSError):
            _pipe(self._child.stdin).close()
        self._watch.join(timeout)
        if self._watch.is_alive():
            raise Failure(f"{self._path}: the recorder is still writing after {timeout:g} s")
        _pipe(self._child.stdout).close()
        if self._child.returncode != 0:
            raise Failure(f"{self._path}: incomplete, {self._cause()}")
        if lost := self._ring.lost - self._lost_before:
            raise Failure(f"{self._path}: incomplete, the recorder was too slow for {lost} ticks or frames")

    def remove(self) -> None:
        """Remove what was recorded, once the recorder has ended: for a run that did not begin."""
        for path in [self._path, *parts_of(self._path)]:
            path.unlink(missing_ok=True)

    def _wait(self) -> None:
        self._child.wait()
        if not self._ending:
            self._ring.forget_reader()
            # A thread has no caller to return this to; without another handler a log goes to stderr as it is.
            _LOG.error("%s: no longer recorded, %s; the run goes on", self._path, self._cause())

    def _cause(self) -> str:
        return _ended(self._child.returncode)


def start_recorder(
    ring: Ring, path: Path, bench: RecordedBench, loop_cpu: int | None = None, rotation: Rotation | None = None
) -> Recorder:
    """Start a recorder for a run of `bench`; returns when its file is there and the ring waits for it.

    Parameters
    ----------
    path
        The file, or the name of its parts; a folder that is there gets one by the bench and the time of day, and the
        parts that were recorded there so before count among those that are kept.
    loop_cpu
        The CPU that the recorder keeps clear of.

    Raises
    ------
    Failure
        When the file exists already or cannot be written, or its ending is that of another format.
    """
    start_utc, rotation = datetime.now(UTC), rotation or Rotation()
    if path.is_dir():
        if rotation.keep:
            rotation = replace(rotation, earlier=_earlier(path, bench.name))
        path = path / _name(bench.name, start_utc)
    return _start(ring, path, describe(bench, start_utc), loop_cpu, rotation)


def description_now(bench: RecordedBench) -> dict[str, str]:
    """Return what recordings that begin late will say of a run that starts now."""
    return describe(bench, datetime.now(UTC))


def start_late(ring: Ring, path: Path, metadata: dict[str, str], loop_cpu: int | None = None) -> Recorder:
    """Start a recorder in the midst of the run that `metadata` describes: it begins with the loop's next row.

    Raises
    ------
    Failure
        As :func:`start_recorder`.
    """
    return _start(ring, path, metadata, loop_cpu, None)


def _start(
    ring: Ring, path: Path, metadata: dict[str, str], loop_cpu: int | None, rotation: Rotation | None
) -> Recorder:
    """Start a recorder; one without rotation begins late.

    Raises
    ------
    Failure
        When the file exists already or cannot be written, or its ending is that of another format.
    """
    late, rotation = rotation is None, rotation or Rotation()
    path = _free(path, rotation)
    order = {"metadata": metadata, "rotation": asdict(rotation), "late": late}
    command = [sys.executable, "-m", "hilplant.recording.drain", ring.name, str(path)]
    lost_before = ring.lost
    child = subprocess.Popen(
        [*command, "" if loop_cpu is None else str(loop_cpu)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        start_new_session=True,
    )
    try:
        with contextlib.suppress(BrokenPipeError):  # its own answer says why it ended
            _pipe(child.stdin).write(json.dumps(order).encode() + b"\n")
            _pipe(child.stdin).flush()
        answer = _answer(child)
    except BaseException:  # Ctrl-C: the recorder sees its pipe end, and leaves no file
        with contextlib.suppress(OSError):
            child.communicate(timeout=_START_TIMEOUT_S)
        raise
    if answer != "ready":
        child.kill()
        child.communicate()
        cause = f"not within {_START_TIMEOUT_S:g} s" if answer is None else _ended(child.returncode)
        raise Failure(answer or f"{path}: the recorder did not start, {cause}")
    return Recorder(child, ring, path, lost_before)


def _word(bench: str) -> str:
    return re.sub(r"[^\w.]+", "-", bench).strip("-.") or "run"


def _earlier(folder: Path, bench: str) -> tuple[str, ...]:
    """Return the parts that were recorded to a folder by the bench's name, the oldest first."""
    named = re.compile(rf"{re.escape(_word(bench))}-(\d{{8}}T\d{{6}}\.\d{{3}})Z-(\d{{4,}})\.hilrec")
    found = [(match[1], int(match[2]), str(path)) for path in folder.iterdir() if (match := named.fullmatch(path.name))]
    return tuple(path for _, _, path in sorted(found))


def _name(bench: str, start_utc: datetime) -> str:
    return f"{_word(bench)}-{start_utc:%Y%m%dT%H%M%S}.{start_utc.microsecond // 1000:03d}Z.hilrec"


def _free(path: Path, rotation: Rotation) -> Path:
    """Return the path, if all that a run will write there is still free."""
    if path.suffix.lower() in _EXPORTED:
        raise Failure(f"{path}: a recording is no {path.suffix} file; record to .hilrec, and hilplant export makes one")
    taken = parts_of(path)
    if taken and (rotation.in_parts or not path.exists()):
        raise Failure(f"{path}: cannot record to this file: there are parts of that name, such as {taken[-1]}")
    return path


def _ended(code: int) -> str:
    return f"the recorder was killed by signal {-code}" if code < 0 else f"the recorder ended with code {code}"


def _answer(child: subprocess.Popen[bytes]) -> str | None:
    """Return what the recorder says of its start, None where it takes too long."""
    answers = _pipe(child.stdout)
    ready, _, _ = select.select([answers], [], [], _START_TIMEOUT_S)
    return answers.readline().decode().strip() if ready else None


def _pipe(pipe: IO[bytes] | None) -> IO[bytes]:
    assert pipe is not None  # the recorder is always started with pipes
    return pipe
