"""Tables of positions, velocities and accelerations: within their bound at places that nobody looked at."""

from pathlib import Path

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.failure import Failure
from hilplant.mechanics.wiper import Wiper
from hilplant.train.kinematic_tables import QUANTITIES, errors_of, exact, look_up, table, within, write_csv
from hilplant.units import TURN_RAD


@pytest.fixture(scope="module")
def wiper() -> Wiper:
    return load_bench("default").plant.mechanics.wiper


@pytest.mark.parametrize("bound", [1e-3, 1e-6])
def test_the_bound_holds_at_random_angles_too(wiper: Wiper, bound: float) -> None:
    rows, _ = within(wiper, bound)
    angles = np.random.default_rng(1).uniform(0.0, TURN_RAD, 2000)
    truth, read = exact(wiper, angles), look_up(rows, angles)
    for ours, theirs in (
        (read.position, truth.position), (read.velocity, truth.velocity), (read.acceleration, truth.acceleration),
    ):  # fmt: skip
        assert (np.abs(ours - theirs).max(axis=0) <= bound * np.abs(theirs).max(axis=0) * 1.001).all()


def test_half_the_knots_would_not_do(wiper: Wiper) -> None:
    rows, _ = within(wiper, 1e-6)
    assert max(error.worst for error in errors_of(wiper, table(wiper, (len(rows) - 1) // 2))) > 1e-6


def test_velocities_and_accelerations_are_derivatives_of_the_positions(wiper: Wiper) -> None:
    angles, step = np.linspace(0.1, 6.1, 50), 1e-4
    here, ahead, behind = (exact(wiper, angles + shift) for shift in (0.0, step, -step))
    assert here.velocity == pytest.approx((ahead.position - behind.position) / (2 * step), abs=1e-6)
    assert here.acceleration == pytest.approx((ahead.velocity - behind.velocity) / (2 * step), abs=1e-5)


def test_a_bound_beyond_the_solution_of_the_positions_is_refused(wiper: Wiper, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hilplant.train.kinematic_tables.MOST", 64)
    with pytest.raises(Failure, match="no table of up to 64 knots keeps within 1e-09"):
        within(wiper, 1e-9)


def test_the_written_table_holds_what_was_found(wiper: Wiper, tmp_path: Path) -> None:
    rows = table(wiper, 64)
    write_csv(rows, tmp_path / "tables.csv")
    head = (tmp_path / "tables.csv").read_text().splitlines()[0].split(",")
    read = np.loadtxt(tmp_path / "tables.csv", delimiter=",", skiprows=1)
    truth = exact(wiper, read[:-1, 0])
    assert read.shape == (65, 1 + 3 * len(QUANTITIES)) and head[1] == "left_rocker_rad"
    assert read[:-1, 1::3] == pytest.approx(truth.position, abs=1e-12)
    assert read[:-1, 3::3] == pytest.approx(truth.acceleration, abs=1e-9)
