"""What the package does with an output, an input and a load that were added to it; run inside the changed copy."""

import lzma
import sys
from pathlib import Path

import numpy as np

from hilplant.bench.assembly import load_bench
from hilplant.models.load import LOADS
from hilplant.recording.replay import replay
from hilplant.signals import INPUT_INDEX, OUTPUTS
from hilplant.simulation.run import simulate

DATA = Path(__file__).parents[1] / "data"
SCENARIO = """
seconds: 0.4
signals:
  relay_on: [[0, true]]
  drag_torque_n_m: [[0, 0.0], [0.2, 3.0]]
"""
SPRING = "extends: linkage_alone.yaml\nname: spring\nplant:\n  load: {model: spring, c1: 2.5}\n"


def main(folder: Path) -> None:
    """Simulate in `folder` with what was added, and compare it with what follows from its few lines."""
    scenario = folder / "drag.yaml"
    scenario.write_text(SCENARIO)
    result = simulate("default", scenario)
    columns = result.columns()
    power = columns["terminal_v"] * columns["current_a"]
    assert np.array_equal(columns["armature_power_w"], power) and power.max() > 10.0
    scenario.write_text(SCENARIO.replace("drag", "brake"))  # of which the drag is a second one
    braked = simulate("default", scenario)["crank_speed_rad_s"]
    scenario.write_text(SCENARIO)
    assert np.abs(columns["crank_speed_rad_s"] - braked).max() < 1e-9 and np.diff(braked)[200] < -1e-4
    assert load_bench("default").input_row[INPUT_INDEX["drag_torque_n_m"]] == 0.0

    bench = folder / "spring.yaml"
    bench.write_text(SPRING)
    loaded = simulate(bench, scenario)
    columns = loaded.columns()
    assert LOADS[int(load_bench(bench).parameters.load.model)] == "spring"
    turning = columns["crank_speed_rad_s"] > 0.0
    expected = 2.5 * np.sin(columns["crank_angle_rad"])
    assert turning.sum() > 300 and np.abs(columns["load_torque_n_m"] - expected)[turning].max() < 1e-9


def replay_older(folder: Path) -> None:
    """Replay a recording from before what was added: it lacks the output, and the input had its default."""
    path = folder / "older.hilrec"
    path.write_bytes(lzma.decompress((DATA / "recordings" / "format_1.hilrec.xz").read_bytes()))
    result = replay(path)
    assert result.equal and result.outputs == 25, str(result)
    (note,) = result.notes
    lacked = note.partition(": ")[2].split(", ")
    assert len(lacked) == len(OUTPUTS) - 25 and "armature_power_w" in lacked


if __name__ == "__main__":
    main(Path(sys.argv[1]))
    replay_older(Path(sys.argv[1]))
