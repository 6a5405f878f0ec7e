"""Positions, velocities and accelerations of all bodies over time, against differences of the positions."""

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.bench.assembly import Bench
from hilplant.failure import Failure
from hilplant.mechanics.solved_motion import solve_motion

STEP_S = 1e-3


@pytest.fixture(scope="module")
def bench() -> Bench:
    return load_bench("default")


def test_velocity_and_acceleration_are_the_derivatives_of_the_position(bench: Bench) -> None:
    solved = solve_motion(bench.plant.mechanics.wiper, 5.0, 1.3, STEP_S, start_rad=0.4)
    assert len(solved.tracks) == len(bench.plant.mechanics.wiper.bodies) - 1 + 6
    for track in solved.tracks:
        for place, rate, change in zip(
            track.position.values(), track.velocity.values(), track.acceleration.values(), strict=True
        ):
            by_difference = (place[2:] - place[:-2]) / (2.0 * STEP_S)
            assert by_difference == pytest.approx(rate[1:-1], abs=3e-4 * max(1.0, np.abs(rate).max()))
            second = (place[2:] - 2.0 * place[1:-1] + place[:-2]) / STEP_S**2
            assert second == pytest.approx(change[1:-1], abs=2e-3 * max(1.0, np.abs(change).max()))


def test_duration_step_and_speed_lay_out_the_instants(bench: Bench) -> None:
    solved = solve_motion(bench.plant.mechanics.wiper, 6.28, 1.0, 0.01)
    assert len(solved.time_s) == 101
    assert solved.crank_rad[-1] == pytest.approx(6.28)
    assert list(solved.columns())[:2] == ["time_s", "crank_rad"]
    assert len(solved.columns()) == 2 + 9 * 14 + 6 * 6 == 2 + 9 * (len(solved.tracks) - 6) + 36


def test_what_cannot_be_solved_says_why(bench: Bench) -> None:
    wiper = bench.plant.mechanics.wiper
    with pytest.raises(Failure, match="above 0"):
        solve_motion(wiper, 1.0, 1.0, 0.0)
    with pytest.raises(Failure, match="instants"):
        solve_motion(wiper, 1.0, 1e6, 1e-3)
    with pytest.raises(Failure, match="there is no body 'arm'; there are crank"):
        solve_motion(wiper, 1.0, 0.1, 0.01).track("arm")
