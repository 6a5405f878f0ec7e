"""The demonstration itself, on the real clock, as short as it goes: the one test here that takes its time."""

import os
import signal
import subprocess
import sys
import time

import pytest

from hilplant.cli.actions.demo import PLOT, RECORDING, run_demo
from hilplant.demo.figures import figures
from hilplant.failure import Failure
from hilplant.recording.export import signal_columns
from hilplant.recording.reader import read_recording
from hilplant.recording.replay import replay


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return where a demonstration was left, over the remains of an earlier one."""
    folder = tmp_path_factory.mktemp("demo")
    for name in (RECORDING, PLOT):
        (folder / name).write_text("of an earlier demonstration")
    run_demo(8.0, folder)
    return folder


def test_it_wipes_slow_and_fast_and_ends_parked(folder):
    found = figures(signal_columns(read_recording(folder / RECORDING))[0])
    assert found.wipes >= 3
    assert 30.0 < found.slow.cycles_per_min < found.fast.cycles_per_min < 80.0
    assert found.stops
    assert all(stop.in_park for stop in found.stops)


def test_its_recording_replays_bit_for_bit_and_its_plot_is_a_picture(folder):
    assert replay(folder / RECORDING).equal
    assert (folder / PLOT).read_bytes().startswith(b"\x89PNG")


def test_a_folder_that_cannot_be_made_is_one_line(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(Failure, match=r"file.*cannot be written"):
        run_demo(8.0, tmp_path / "file" / "demo")


def test_ctrl_c_before_the_plant_runs_leaves_nothing_and_says_nothing(tmp_path):
    command = [sys.executable, "-m", "hilplant", "demo", "--out", str(tmp_path)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    demo = subprocess.Popen(
        command, text=True, start_new_session=True, env=os.environ | {"PYTHONUNBUFFERED": "1"}, **pipes
    )
    while "preparing" not in demo.stdout.readline():
        pass
    os.killpg(demo.pid, signal.SIGINT)
    _, said = demo.communicate(timeout=60)
    assert (demo.returncode, said) == (130, "")
    assert list(tmp_path.iterdir()) == []


def test_ctrl_c_ends_it_early_with_a_summary_of_what_was_done(tmp_path):
    command = [sys.executable, "-m", "hilplant", "demo", "--seconds", "60", "--out", str(tmp_path)]
    demo = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True)
    for line in demo.stdout:
        if line.lstrip().startswith("1."):  # the line of the second second: it runs
            break
    os.killpg(demo.pid, signal.SIGINT)
    begin_s = time.monotonic()
    rest, _ = demo.communicate(timeout=60)
    assert demo.returncode == 0
    assert time.monotonic() - begin_s < 30.0
    assert "wipes" in rest
    assert (tmp_path / PLOT).exists()
