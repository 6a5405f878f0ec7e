"""Section 6.4.4: alone the network is wrong where it was not trained, guarded it is not; and nothing else differs."""

import math

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.failure import Failure
from hilplant.motor_bench.windings import Armature, path_resistance
from hilplant.train import bare_network
from hilplant.train.bare_network import bare_run


def test_alone_it_is_wrong_off_and_above_its_voltages_and_guarded_it_is_right(monkeypatch: pytest.MonkeyPatch) -> None:
    """A load that drives would turn the motor backwards; the worm holds it, which no training has shown."""
    monkeypatch.setattr(bare_network, "END_S", 2.6)
    monkeypatch.setattr(bare_network, "BEGIN_S", 0.3)
    monkeypatch.setattr(bare_network, "BEYOND", {"off": (0.6, 1.0, 0.0), "at_25_v": (1.4, 1.8, 25.0)})
    found = bare_run(load_bench("networks"))
    bare, guarded = found.errors("bare"), found.errors("guarded")
    assert bare["bare_off_current_a"] > 1.0 and bare["bare_off_crank_speed_rad_s"] > 0.5
    assert bare["bare_at_25_v_current_a"] > 0.1
    for part in ("off", "at_25_v"):
        assert guarded[f"guarded_{part}_current_a"] < 0.02
        assert guarded[f"guarded_{part}_crank_speed_rad_s"] < 0.01
    assert np.all(found.active[(found.time_s > 0.7) & (found.time_s < 1.0)] == 0.0)
    assert np.isnan(found.columns()["bare_current_a"][0])


def test_a_bench_without_a_motor_network_is_refused() -> None:
    with pytest.raises(Failure, match="the bench networks has one"):
        bare_run(load_bench("default"))


@pytest.mark.parametrize(("coils", "angle_deg", "paths"), [(12, 60.0, (4, 8)), (12, 90.0, (3, 9)), (10, 72.0, (3, 7))])
def test_two_parallel_paths_have_the_resistance_of_their_coils(
    coils: int, angle_deg: float, paths: tuple[int, int]
) -> None:
    armature = Armature(coils, coils // 2 - 1, angle_deg)
    assert path_resistance(armature, False) == pytest.approx(coils / 4)
    assert path_resistance(armature, True) == pytest.approx(math.prod(paths) / coils)
