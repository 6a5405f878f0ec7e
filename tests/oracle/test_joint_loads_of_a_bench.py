"""Joint forces of a whole bench: the crank's torque by Lagrange multipliers is that of the load that knows no joint."""

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.bench.assembly import Bench
from hilplant.simulation.crank_torque import Conditions, crank_torque
from hilplant.simulation.joint_loads import joint_loads

CONDITIONS = [Conditions(0.0), Conditions(1.0), Conditions(0.5, 20.0), Conditions(1.0, 40.0), Conditions(1.0, 0.0, 2.0)]
TURN_A_SECOND = 2.0 * np.pi
BENCHES = {
    "default": "extends: default.yaml\n",
    "spoiler": "extends: spoiler.yaml\n",
    "points": "extends: default.yaml\nplant:\n  load: {model: reduced, points: 4}\n"
    "  linkage: linkages/lhd_centre_driven.yaml\n",
}


@pytest.fixture(scope="module", params=BENCHES)
def bench(request: pytest.FixtureRequest) -> Bench:
    return load_bench(BENCHES[request.param])


@pytest.mark.parametrize("conditions", CONDITIONS)
def test_the_crank_torque_is_that_of_the_reduced_load(bench: Bench, conditions: Conditions) -> None:
    speed = TURN_A_SECOND if conditions.wetness == 1.0 else -0.5 * TURN_A_SECOND
    found = joint_loads(bench, speed, conditions)
    some = slice(3, None, 60)
    reduced = crank_torque(bench, found.moving.crank_rad[some], speed, conditions)
    ours = found.loads.crank_torque_n_m[some]
    assert np.abs(ours - reduced).max() < 1e-6 * np.abs(reduced).max() + 2e-6


def test_the_columns_name_every_joint_once_with_size_parts_and_moment() -> None:
    found = joint_loads(load_bench("default"), TURN_A_SECOND, Conditions(0.0))
    columns = found.columns()
    assert len(columns) == 2 + 4 * len(found.loads.joints)
    assert columns["ground_to_crank_n"] == pytest.approx(
        np.hypot(columns["ground_to_crank_x_n"], columns["ground_to_crank_y_n"])
    )
