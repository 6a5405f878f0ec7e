"""A page that is told to end does so at once, leaves nothing, and has done what it was to do: exit code 0."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest


@pytest.mark.parametrize("told", [[signal.SIGTERM], [signal.SIGINT, signal.SIGINT]])
def test_the_modelling_page_ends_with_a_signal_or_a_second_one(tmp_path: Path, told: list[signal.Signals]) -> None:
    command = [sys.executable, "-m", "hilplant", "model", "--no-browser", "--address", "0"]
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment, text=True) as page:
        assert page.stdout is not None and re.search(r"http://127\.0\.0\.1:\d+/#token=", page.stdout.readline())
        assert [path.name for path in tmp_path.glob("hilplant-modelling-*")]
        for each in told:
            page.send_signal(each)
            time.sleep(0.02)
        said = page.communicate(timeout=60)
    assert (page.returncode, *said) == (0, "", "")
    assert not list(tmp_path.glob("hilplant-modelling-*"))
