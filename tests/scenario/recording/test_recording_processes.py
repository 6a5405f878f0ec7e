"""The recorder is a process of its own: what each of the two loses when the other, or itself, is killed."""

import fcntl
import os
import resource
import select
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from hilplant.failure import Failure
from hilplant.recording.reader import read_recording
from hilplant.recording.recorder import Recorder, start_recorder
from hilplant.recording.replay import replay
from hilplant.recording.rotation import Rotation, parts_of
from hilplant.runtime.ring import Ring

DAEMON = """
import importlib.util, sys
from pathlib import Path
specification = importlib.util.spec_from_file_location("helpers", sys.argv[1])
helpers = importlib.util.module_from_spec(specification)
sys.modules["helpers"] = helpers
specification.loader.exec_module(helpers)
from hilplant.recording.recorder import start_recorder
ring = helpers.Ring.create(helpers.ROW_WIDTH)
run = helpers.Run(ring)
recorder = start_recorder(ring, Path(sys.argv[2]), run.bench)
run.go(2500)
print(recorder.pid, ring.name, flush=True)
sys.stdin.readline()
"""


@pytest.fixture
def run(start_run: Callable[[Ring], Any], row_width: int) -> Iterator[Any]:
    ring = Ring.create(row_width)
    yield start_run(ring)
    ring.close()


def wait_for_rows(path: Path, ticks: int) -> None:
    """Wait until the file holds `ticks` rows; the recorder writes every half second."""
    pause = threading.Event()
    while len(read_recording(path).table(["tick"])) < ticks:
        pause.wait(0.02)


def wait_for_death(recorder: Recorder) -> None:
    pause = threading.Event()
    while recorder.alive():
        pause.wait(0.01)


def wait_for_end(pid: int) -> None:
    try:
        descriptor = os.pidfd_open(pid)
    except ProcessLookupError:
        return
    assert select.select([descriptor], [], [], 20.0)[0], "the recorder did not end"
    os.close(descriptor)


def test_a_recorded_run_is_complete_and_replays_bit_for_bit(run: Any, tmp_path: Path) -> None:
    path = tmp_path / "run.hilrec"
    recorder = start_recorder(run.ring, path, run.bench)
    run.go(3000)
    recorder.finish()
    assert not recorder.alive()
    table = read_recording(path).table()
    assert len(table) == 3000
    assert table.column("frames").combine_chunks().value_lengths().to_pylist() == [1] * 3000
    result = replay(path)
    assert (result.equal, result.ticks, result.notes) == (True, 3000, ())
    assert run.ring.lost == 0


def test_the_recorder_ignores_the_signals_meant_for_the_daemon(run: Any, tmp_path: Path) -> None:
    path = tmp_path / "run.hilrec"
    recorder = start_recorder(run.ring, path, run.bench)
    run.go(100)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGABRT):
        os.kill(recorder.pid, number)
    run.go(100)
    recorder.finish()
    assert len(read_recording(path).table()) == 200


def test_in_a_folder_parts_of_earlier_starts_count_among_those_that_are_kept(run: Any, tmp_path: Path) -> None:
    """None but parts of the same bench in that folder, and none that somebody still records to."""
    spared = [tmp_path / "small-bench-20260101T000000.000Z.hilrec", tmp_path / "small-bench-2-0001.hilrec"]
    old = [tmp_path / f"small-bench-20260101T000000.000Z-{number:04d}.hilrec" for number in (1, 2, 3, 10)]
    other = tmp_path / "small-benches-20260101T000000.000Z-0001.hilrec"
    for path in (*spared, *old, other):
        path.write_text("")
    with old[1].open("rb") as busy:
        fcntl.flock(busy, fcntl.LOCK_EX)
        recorder = start_recorder(run.ring, tmp_path, run.bench, rotation=Rotation(part_ns=1_000_000_000, keep=3))
        assert not old[0].exists()
        run.go(2500)
        recorder.finish()
    parts = parts_of(recorder.path)
    assert sorted(tmp_path.iterdir()) == sorted([*spared, other, old[1], *parts])
    assert [part.stem[-4:] for part in parts] == ["0001", "0002", "0003"]
    assert replay(recorder.path).ticks == 2500


def test_a_file_that_is_there_already_is_left_alone(run: Any, tmp_path: Path) -> None:
    path = tmp_path / "run.hilrec"
    path.write_text("dear data")
    with pytest.raises(Failure, match="cannot record to this file: File exists"):
        start_recorder(run.ring, path, run.bench)
    assert path.read_text() == "dear data"


def test_a_folder_that_is_not_there_is_said_before_the_run(run: Any, tmp_path: Path) -> None:
    with pytest.raises(Failure, match=r"run\.mf4: a recording is no \.mf4 file; record to \.hilrec"):
        start_recorder(run.ring, tmp_path / "run.mf4", run.bench)
    with pytest.raises(Failure, match="cannot record to this file: No such file or directory"):
        start_recorder(run.ring, tmp_path / "nowhere" / "run.hilrec", run.bench)


def test_a_recorder_that_takes_too_long_to_start_is_said_so(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("hilplant.recording.recorder._START_TIMEOUT_S", 0.0)
    with pytest.raises(Failure, match=r"run\.hilrec: the recorder did not start, not within 0 s"):
        start_recorder(run.ring, tmp_path / "run.hilrec", run.bench)


def test_a_full_disk_is_said_and_the_run_goes_on(
    run: Any, tmp_path: Path, capfd: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "run.hilrec"
    recorder = start_recorder(run.ring, path, run.bench)
    size = path.stat().st_size + 1000
    resource.prlimit(recorder.pid, resource.RLIMIT_FSIZE, (size, size))
    run.go(2000)
    wait_for_death(recorder)
    told = capfd.readouterr().err
    assert "the recording ends early: File too large" in told
    assert "no longer recorded" in caplog.text
    with pytest.raises(Failure, match="incomplete"):
        recorder.finish()
    run.go(100)
    assert run.ring.lost == 0


def test_when_the_daemon_is_killed_the_recorder_saves_everything_and_ends(tmp_path: Path) -> None:
    path = tmp_path / "run.hilrec"
    helpers = Path(__file__).parent / "conftest.py"
    daemon = subprocess.Popen(
        [sys.executable, "-c", DAEMON, str(helpers), str(path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert daemon.stdout is not None
    pid, ring_name = daemon.stdout.readline().split()
    os.kill(daemon.pid, signal.SIGKILL)
    wait_for_end(int(pid))
    daemon.communicate()
    result = replay(path)
    assert (result.equal, result.ticks, result.notes) == (True, 2500, ())
    with pytest.raises(FileNotFoundError):
        Ring.attach(ring_name)


def test_when_the_recorder_is_killed_the_file_keeps_all_but_the_last_moment_and_the_run_goes_on(
    run: Any, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "run.hilrec"
    recorder = start_recorder(run.ring, path, run.bench)
    run.go(1000)
    wait_for_rows(path, 1000)
    run.go(10)
    os.kill(recorder.pid, signal.SIGKILL)
    wait_for_death(recorder)
    with pytest.raises(Failure, match="incomplete, the recorder was killed by signal 9"):
        recorder.finish()
    assert "the recorder was killed by signal 9; the run goes on" in caplog.text
    run.go(40_000)
    assert run.ring.lost == 0
    result = replay(path)
    assert result.equal
    assert result.ticks >= 1000
    assert "cut off" in result.notes[0]
