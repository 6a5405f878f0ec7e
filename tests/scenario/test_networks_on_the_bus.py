"""Networks in place of motor and load drive the server on a bus, with the stand-in ECU at the other end.

Truth is the physical plant under the same ECU: the same frames, as many park stops, at the same angles, and nearly the
same current. The ECU looks every millisecond here: at its usual five, two plants that are microseconds apart may stop
one look, up to 2 degrees, apart. `hilplant study surrogates` runs ten minutes of it.
"""

from typing import Any

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.models.narx import NETWORK
from hilplant.simulation.bus_run import ROUND_S, BusRun, drive

BENCHES = {
    "networks": "networks",
    "torque network": "network",
    "motor network": "extends: default.yaml\nname: motor\n"
    "plant: {motor_model: {model: narx, file: surrogates/motor_default.yaml}}\n",
}


@pytest.fixture(scope="module")
def physical() -> BusRun:
    return drive(load_bench("default"), 2.0 * ROUND_S, look_ms=1.0)


@pytest.mark.parametrize("name", BENCHES)
def test_frames_stops_and_current_are_those_of_the_physical_plant(name: str, physical: BusRun, tmp_path: Any) -> None:
    text = BENCHES[name]
    if "extends" in text:
        (tmp_path / "bench.yaml").write_text(text)
        text = str(tmp_path / "bench.yaml")
    ours = drive(load_bench(text), 2.0 * ROUND_S, look_ms=1.0)
    assert set(ours.frames) == set(physical.frames)
    assert len(ours.stops()) == len(physical.stops()) >= 10
    assert np.degrees(np.abs(ours.stops() - physical.stops())).max() < 1.0
    assert ours.turns == pytest.approx(physical.turns, abs=0.01)
    error = np.sqrt(np.mean((ours["current_a"] - physical["current_a"]) ** 2))
    assert error < 0.03 * np.ptp(physical["current_a"])
    charged = [float((ours[mode] == NETWORK).mean()) for mode in ("load_mode", "motor_mode")]
    wanted = {"networks": (0.5, 0.5), "torque network": (0.5, 0.0), "motor network": (0.0, 0.5)}[name]
    assert all(share >= least for share, least in zip(charged, wanted, strict=True))
