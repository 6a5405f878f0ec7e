"""The head of an exported ASC log has the date of the run, whatever the day of the export."""

from datetime import UTC, datetime
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from hilplant.recording.frame_logs import write_frame_log


@pytest.mark.parametrize("micro", [0, 5_000, 349_000])
def test_the_date_is_that_of_the_run(tmp_path: Path, micro: int) -> None:
    start = datetime(2021, 3, 4, 5, 6, 7, micro, UTC)
    run: Any = SimpleNamespace(run=SimpleNamespace(start_utc=start), batches=lambda: [])
    write_frame_log(run, tmp_path / "a.asc")
    local = start.astimezone()
    written = (tmp_path / "a.asc").read_text().splitlines()[0]
    assert written == local.strftime(f"date %a %b %d %H:%M:%S.{micro // 1000:03d} %Y")
