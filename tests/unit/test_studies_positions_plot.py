"""The picture of four wiper positions: it is written, shows both arms, and says why it cannot be."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from matplotlib.colors import to_rgb
from matplotlib.image import imread
from numpy.typing import NDArray

from hilplant.failure import Failure
from hilplant.mechanics.arms import arm_points
from hilplant.mechanics.blades import blade_tips
from hilplant.mechanics.slave_driven import slave_driven
from hilplant.mechanics.wiper import SideParts, Wiper, WiperParts, assemble
from hilplant.plots.positions import plot_positions
from hilplant.resources import shipped

LEFT, RIGHT, CRANK = "#0b5cad", "#d9730d", "#b3261e"


@pytest.fixture(scope="module")
def wiper() -> Wiper:
    written = yaml.safe_load(shipped("config", "linkages", "rhd_slave_driven.yaml").read_text())
    left, right = (
        SideParts(
            arm_points(written[f"{name}_arm"]["kind"], written[f"{name}_arm"]["points_m"]),
            blade_tips(written[f"{name}_blade"]["points_m"]),
        )
        for name in ("left", "right")
    )
    return assemble(WiperParts(slave_driven(written["points_m"]), left, right))


def centre_of(picture: NDArray[np.float32], color: str) -> tuple[float, float]:
    """Return where the pixels of a colour are on average, from the top left."""
    rows, columns = np.nonzero(np.abs(picture[..., :3] - to_rgb(color)).max(axis=2) < 0.02)
    assert rows.size > 50
    return float(rows.mean()), float(columns.mean())


def test_both_arms_and_the_crank_are_in_every_panel_and_the_arms_rise(wiper: Wiper, tmp_path: Path) -> None:
    plot_positions(wiper, tmp_path / "four.png", "four positions")
    picture = np.asarray(imread(tmp_path / "four.png"))
    half = picture.shape[1] // 2
    height = picture.shape[0] // 2
    panels = [picture[top : top + height, side : side + half] for top in (0, height) for side in (0, half)]
    for panel in panels:
        assert centre_of(panel, LEFT)[1] < centre_of(panel, RIGHT)[1]
        centre_of(panel, CRANK)
    up = [centre_of(panel[: -panel.shape[0] // 8], LEFT)[0] for panel in panels]  # above the legend
    assert up[0] > up[1]
    assert up[2] > up[3]


@pytest.mark.parametrize("count", [1, 2, 3, 5, 16])
def test_any_number_of_positions_is_drawn_each_with_its_angle(wiper: Wiper, tmp_path: Path, count: int) -> None:
    angles = tuple(np.linspace(10.0, 350.0, count).tolist())
    plot_positions(wiper, tmp_path / "some.svg", "some", angles)
    text = (tmp_path / "some.svg").read_text()
    assert all(f"crank {angle:g}°" in text for angle in angles)


@pytest.mark.parametrize("angles", [(), tuple(range(17))])
def test_no_position_and_too_many_are_refused(wiper: Wiper, tmp_path: Path, angles: tuple[float, ...]) -> None:
    with pytest.raises(Failure, match=f"1 to 16 positions are drawn, not {len(angles)}"):
        plot_positions(wiper, tmp_path / "none.png", "none", angles)


def test_a_picture_that_cannot_be_written_says_so(wiper: Wiper, tmp_path: Path) -> None:
    with pytest.raises(Failure, match=r"four\.png: cannot be written: No such file"):
        plot_positions(wiper, tmp_path / "nowhere" / "four.png", "four")
