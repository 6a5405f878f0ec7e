"""`hilplant run --controller`: the daemon on the shipped in-memory bench, and what it says to wrong use."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from hilplant.cli.main import app
from hilplant.failure import Failure
from hilplant.recording.replay import replay


def test_the_daemon_runs_it_on_the_wall_clock_and_the_recording_can_be_repeated(tmp_path: Path):
    path = tmp_path / "inside.hilrec"
    words = "run virtual --controller cascade --reference 2.5 --seconds 0.8 --record"
    answer = CliRunner().invoke(app, [*words.split(), str(path)])
    assert answer.exit_code == 0, answer.output
    assert replay(path).equal


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--controller", "nope"], r"there is no controller 'nope'; there are pid, .*cascade"),
        (["--controller", "pid", "--reference", "quick"], "reference: 'quick' is not a speed in rad/s"),
        (["--reference", "3"], "give --controller NAME with it"),
    ],
)
def test_wrong_use_is_told_in_one_line(words, told):
    answer = CliRunner().invoke(app, ["run", "virtual", *words])
    assert isinstance(answer.exception, Failure)
    with pytest.raises(Failure, match=told):
        raise answer.exception
