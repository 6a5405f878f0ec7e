"""What is lost of a recording is said at once in the status, and at the end by a failure, however it was lost."""

import os
import signal
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
from hilplant.signals import RECORDING


@pytest.fixture
def run(start_run: Callable[[Ring], Any], row_width: int) -> Iterator[Any]:
    ring = Ring.create(row_width, rows=16_384)
    yield start_run(ring)
    ring.close()


def status(run: Any) -> str:
    return RECORDING[run.ring.recording]


def wait_until(done: Callable[[], bool]) -> None:
    pause = threading.Event()
    for _ in range(2000):
        if done():
            return
        pause.wait(0.01)
    raise AssertionError("nothing happened for 20 s")


def removed(path: Path) -> None:
    path.unlink()


def truncated(path: Path) -> None:
    path.write_bytes(b"")


def cut_in_the_middle(path: Path) -> None:
    os.truncate(path, path.stat().st_size // 2)


def grown(path: Path) -> None:
    with path.open("ab") as file:
        file.write(b"somebody else's")


def moved(path: Path) -> None:
    path.rename(path.with_name("elsewhere"))


def replaced(path: Path) -> None:
    path.rename(path.with_name("elsewhere"))
    path.write_bytes(path.with_name("elsewhere").read_bytes())


def folder_moved(path: Path) -> None:
    """As a lazy unmount does: the file goes on existing, its path leads nowhere."""
    path.parent.rename(path.parent.with_name("unmounted"))


@pytest.fixture
def told(capfd: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture) -> Callable[[], str]:
    """Return what the recorder's process and this one have told so far."""
    return lambda: capfd.readouterr().err + caplog.text


@pytest.mark.parametrize("harm", [removed, truncated, cut_in_the_middle, grown, moved, replaced, folder_moved])
@pytest.mark.parametrize("rotation", [Rotation(), Rotation(part_bytes=10_000_000)], ids=["one", "parts"])
def test_a_file_that_is_harmed_during_the_run_is_noticed_during_the_run(
    run: Any,
    tmp_path: Path,
    harm: Callable[[Path], None],
    rotation: Rotation,
    told: Callable[[], str],
) -> None:
    folder = tmp_path / "mounted"
    folder.mkdir()
    path = folder / "run.hilrec"
    recorder = start_recorder(run.ring, path, run.bench, rotation=rotation)
    run.go(700)
    assert status(run) == "complete"
    harm(parts_of(path)[0] if rotation.in_parts else path)
    wait_until(lambda: status(run) == "lossy")
    wait_until(lambda: not recorder.alive())
    run.go(20_000)
    assert run.ring.lost == 0, "nobody reads: the ring goes round"
    assert status(run) == "lossy"
    with pytest.raises(Failure, match="incomplete, the recorder ended with code 1"):
        recorder.finish()
    heard = told()
    assert "the file was" in heard
    assert "the run goes on" in heard


def test_a_file_harmed_after_its_last_block_is_noticed_at_the_end(run: Any, tmp_path: Path) -> None:
    path = tmp_path / "run.hilrec"
    recorder = start_recorder(run.ring, path, run.bench)
    run.go(10)
    stop(recorder)
    path.unlink()
    run.ring.close_writer()
    os.kill(recorder.pid, signal.SIGCONT)
    with pytest.raises(Failure, match="incomplete"):
        recorder.finish()


def stop(recorder: Recorder) -> None:
    os.kill(recorder.pid, signal.SIGSTOP)
    stat = Path(f"/proc/{recorder.pid}/stat")
    wait_until(lambda: stat.read_text().rpartition(")")[2].split()[0] == "T")


def test_a_recorder_that_stood_still_for_too_long_makes_the_end_a_failure(run: Any, tmp_path: Path) -> None:
    """The ring holds 16,384 rows: of 20,000 at least 3,616 find it full."""
    path = tmp_path / "run.hilrec"
    recorder = start_recorder(run.ring, path, run.bench)
    stop(recorder)
    run.go(16_000)
    assert status(run) == "complete", "nothing is lost yet"
    run.go(4_000)
    assert status(run) == "lossy"
    os.kill(recorder.pid, signal.SIGCONT)
    with pytest.raises(
        Failure, match=rf"{path}: incomplete, the recorder was too slow for {run.ring.lost} ticks or fra"
    ):
        recorder.finish()
    assert run.ring.lost >= 3_616
    (note,) = replay(path).notes
    assert f"{run.ring.lost} ticks or frames are missing" in note


def test_a_gap_in_the_middle_is_a_gap_of_the_replay(run: Any, tmp_path: Path) -> None:
    path = tmp_path / "run.hilrec"
    recorder = start_recorder(run.ring, path, run.bench)
    stop(recorder)
    run.go(17_000)
    os.kill(recorder.pid, signal.SIGCONT)
    wait_until(lambda: len(read_recording(path).table(["tick"])) >= 16_384)
    run.go(600)
    with pytest.raises(Failure, match="incomplete"):
        recorder.finish()
    result = replay(path)
    assert (result.equal, result.ticks, result.missing) == (False, 16_984, ((16_384, 16_999),))


def test_a_killed_recorder_shows_in_the_status(run: Any, tmp_path: Path) -> None:
    recorder = start_recorder(run.ring, tmp_path / "run.hilrec", run.bench)
    run.go(10)
    os.kill(recorder.pid, signal.SIGKILL)
    wait_until(lambda: status(run) == "lossy")
    with pytest.raises(Failure, match="killed by signal 9"):
        recorder.finish()


def test_without_a_recorder_nothing_is_called_lost(run: Any) -> None:
    run.go(20_000)
    assert status(run) == "off"


def test_a_recording_is_its_owners_alone_and_a_folder_names_it_anew_each_time(run: Any, tmp_path: Path) -> None:
    names = []
    for _ in range(2):
        recorder = start_recorder(run.ring, tmp_path, run.bench)
        names.append(recorder.path)
        recorder.finish()
    assert len(set(names)) == 2
    assert all(name.stat().st_mode & 0o777 == 0o600 for name in names)
    assert all(name.name.startswith("small-bench-2") and name.suffix == ".hilrec" for name in names)


def test_parts_of_an_earlier_run_are_left_alone(run: Any, tmp_path: Path) -> None:
    path = tmp_path / "run.hilrec"
    earlier = tmp_path / "run-0007.hilrec"
    earlier.write_text("dear data")
    with pytest.raises(Failure, match=r"there are parts of that name, such as .*run-0007"):
        start_recorder(run.ring, path, run.bench, rotation=Rotation(part_bytes=10_000_000))
    assert earlier.read_text() == "dear data"
