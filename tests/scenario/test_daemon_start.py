"""A daemon that cannot start leaves nothing behind."""

from pathlib import Path

import pytest

from hilplant.bus.transport import TransportError
from hilplant.cli.actions.run import run_daemon
from hilplant.recording.beside_loop import RecordTo


def test_an_interface_that_cannot_be_opened_leaves_no_recording_in_the_way(tmp_path: Path) -> None:
    path = tmp_path / "run.hilrec"
    for _ in range(2):
        with pytest.raises(TransportError):
            run_daemon("default", 1.0, RecordTo(path), "nocan9")
        assert not path.exists()
