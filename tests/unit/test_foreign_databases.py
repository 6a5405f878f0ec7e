"""The script that compares whole folders of databases with cantools, on the databases of this project."""

from pathlib import Path

import pytest
from foreign_databases import compare

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("folder", [ROOT / "dbc", ROOT / "tests" / "data" / "bus"])
def test_every_signal_is_read_and_written_as_cantools_does(folder: Path) -> None:
    said: list[str] = []
    counts = compare(folder, said.append)
    assert not any("differ" in what for what in counts), said
    assert counts["signals alike in both directions"] > 3
