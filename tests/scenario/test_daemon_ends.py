"""However a run ends, what it came to is told: summary, JSON, recording and exit code, without a traceback."""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from hilplant.recording.reader import read_recording

PATIENCE_S = 200.0
#: A busy machine puts this bench never behind; the exit code is then about the rest.
BENCH = "extends: virtual.yaml\nloop:\n  lost_time: 1.0\n"
Start = Callable[..., subprocess.Popen[bytes]]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    """Start `hilplant run` with these options, in a session of its own, both streams to pipes."""
    (tmp_path / "patient.yaml").write_text(BENCH)
    started: list[subprocess.Popen[bytes]] = []

    def begin(*options: str, **more: Any) -> subprocess.Popen[bytes]:
        words = [sys.executable, "-m", "hilplant", "run", "patient.yaml", "--no-channel", *options]
        given = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "start_new_session": True, **more}
        environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
        started.append(subprocess.Popen(words, cwd=tmp_path, stdin=subprocess.DEVNULL, env=environment, **given))
        return started[-1]

    yield begin
    for process in started:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def serves(run: subprocess.Popen[bytes]) -> None:
    assert run.stdout is not None
    assert b"serves on" in run.stdout.readline()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_a_signal_ends_it_with_summary_and_json(start: Start, tmp_path: Path, number: signal.Signals) -> None:
    run = start("--json", "o.json")
    serves(run)
    run.send_signal(number)
    said, errors = run.communicate(timeout=PATIENCE_S)
    assert (run.returncode, b" ticks, " in said, b"Traceback" in errors) == (0, True, False), errors
    assert json.loads((tmp_path / "o.json").read_text())["ticks"] > 0


def test_a_reader_that_leaves_after_the_first_line_takes_nothing_with_it(start: Start, tmp_path: Path) -> None:
    run = start("--seconds", "1", "--json", "o.json", "--record", "run.hilrec")
    serves(run)
    assert run.stdout is not None
    run.stdout.close()
    run.stdout = None
    _, errors = run.communicate(timeout=PATIENCE_S)
    assert (run.returncode, b"Traceback" in errors) == (0, False), errors
    ticks = json.loads((tmp_path / "o.json").read_text())["ticks"]
    assert len(read_recording(tmp_path / "run.hilrec").table(["tick"])) == ticks


def test_more_signals_while_the_recorder_ends_do_not_cut_its_work_short(start: Start, tmp_path: Path) -> None:
    run = start("--record", "run.hilrec", "--json", "o.json")
    serves(run)
    end_s = time.monotonic() + PATIENCE_S
    while not (written := tmp_path / "o.json").exists() or not written.stat().st_size:
        assert run.poll() is None and time.monotonic() < end_s
        os.killpg(run.pid, signal.SIGINT)
        time.sleep(0.01)
    _, errors = run.communicate(timeout=PATIENCE_S)
    assert (run.returncode, b"Traceback" in errors) == (0, False), errors
    ticks = json.loads((tmp_path / "o.json").read_text())["ticks"]
    assert len(read_recording(tmp_path / "run.hilrec").table(["tick"])) == ticks


def test_a_signal_before_the_first_tick_leaves_nothing_in_the_way(start: Start, tmp_path: Path) -> None:
    run = start("--record", "run.hilrec")
    while run.poll() is None and not (tmp_path / "run.hilrec").exists():
        time.sleep(0.001)
    run.send_signal(signal.SIGINT)
    _, errors = run.communicate(timeout=PATIENCE_S)
    assert run.returncode in (0, 1, 130) and b"Traceback" not in errors, errors
    left = tmp_path / "run.hilrec"
    assert not left.exists() or len(read_recording(left).table(["tick"])) > 0


def test_no_room_for_the_head_of_the_recording_is_one_line_and_nothing_starts(start: Start, tmp_path: Path) -> None:
    def no_room() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)

    (tmp_path / "disk").mkdir()
    run = start("--seconds", "1", "--record", "disk/run.hilrec", preexec_fn=no_room)
    said, errors = run.communicate(timeout=PATIENCE_S)
    assert run.returncode == 2 and b"serves on" not in said
    assert len(errors.splitlines()) == 1, errors
    assert list((tmp_path / "disk").iterdir()) == []
