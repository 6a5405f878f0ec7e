"""The picture of the park sequences: it is drawn, and one that cannot be written is told in one line."""

from pathlib import Path

import pytest

from hilplant.failure import Failure
from hilplant.plots.park import plot_park_sequences


def test_the_three_sequences_are_drawn(tmp_path: Path) -> None:
    picture = tmp_path / "park.png"
    plot_park_sequences(picture)
    assert picture.read_bytes().startswith(b"\x89PNG")
    with pytest.raises(Failure, match=r"nowhere.*cannot be written"):
        plot_park_sequences(tmp_path / "nowhere" / "park.png")
