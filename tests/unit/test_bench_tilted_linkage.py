"""A linkage whose points were written in the vehicle's axes is refused; layers along Z are not."""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml

from hilplant.bench import check_bench
from hilplant.resources import shipped

LINKAGES = sorted(path.stem for path in shipped("config", "linkages").glob("*.yaml"))


def problems(folder: Path, data: dict[str, object]) -> list[str]:
    (folder / "own.yaml").write_text(yaml.safe_dump(data))
    return [problem.text for problem in check_bench("extends: default.yaml\nname: x\nplant: {linkage: "
                                                     f"{folder / 'own.yaml'}}}\n")]  # fmt: skip


def turned(name: str, axis: int, angle_rad: float, layer_m: float = 0.0) -> dict[str, object]:
    """Return a shipped linkage turned about an axis; every second point of the linkage lies in another layer."""
    data = yaml.safe_load(shipped("config", "linkages", f"{name}.yaml").read_text())
    first, second = [index for index in range(3) if index != axis]
    parts = [data, *(data[f"{side}_{part}"] for side in ("left", "right") for part in ("arm", "blade"))]
    for part in parts:
        for number, (key, point) in enumerate(part["points_m"].items()):
            x = np.array([*point, 0.0][:3])
            x[2] += layer_m * (number % 2) if part is data else 0.0
            x[first], x[second] = (
                math.cos(angle_rad) * x[first] - math.sin(angle_rad) * x[second],
                math.sin(angle_rad) * x[first] + math.cos(angle_rad) * x[second],
            )
            part["points_m"][key] = [float(value) for value in x]
    return data


@pytest.mark.parametrize("angle_deg", [-60.0, -32.7, -5.0, 3.0, 20.0, 45.0])
@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("name", LINKAGES[:3])
def test_a_tilted_linkage_is_refused_with_its_angle(tmp_path: Path, name: str, axis: int, angle_deg: float) -> None:
    found = problems(tmp_path, turned(name, axis, math.radians(angle_deg)))
    assert any(f"tilted by {abs(angle_deg):.1f} deg" in text for text in found), found


@pytest.mark.parametrize("layer_m", [0.0, 0.005, 0.02])
@pytest.mark.parametrize("name", LINKAGES)
def test_layers_are_no_tilt(tmp_path: Path, name: str, layer_m: float) -> None:
    assert not [text for text in problems(tmp_path, turned(name, 0, 0.0, layer_m)) if "tilted" in text]
