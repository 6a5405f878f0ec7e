"""The compiled torque network against textbook formulas on its file's numbers, against differences, and against C."""

import numpy as np
import pytest

from hilplant.arrays import Floats
from hilplant.bench.load_files import TorqueFile
from hilplant.models.torque_network import network_tangent
from hilplant.models.torque_samples import network_tangents, network_torques
from hilplant.perf.c_step import compile_network

STATES = np.column_stack([np.linspace(0.0, 6.28, 500), np.random.default_rng(1).uniform(1.0, 7.0, 500)])


def random_file(harmonics: int) -> TorqueFile:
    random = np.random.default_rng(harmonics)
    inputs = max(1, 2 * harmonics) + 1
    words = dict.fromkeys(("format", "bench", "command", "version", "parameter_hash", "data_hash", "content_hash"), "x")
    return TorqueFile.model_validate(words | {
        "seed": 1, "harmonics": harmonics, "training": {},
        "scaling": {"speed_rad_s": [1.0, 7.0], "dry_n_m": [-1.5, 20.0], "wet_n_m": [-9.0, 8.0]},
        "hidden": random.normal(size=(6, inputs + 1)).tolist(), "output": random.normal(size=(2, 7)).tolist(),
        "errors": {}, "bounds": {"dry_n_m": 1.0, "wet_n_m": 1.0},
    })  # fmt: skip


def textbook(file: TorqueFile, states: Floats) -> Floats:
    """(6.6), (6.7) with inputs and outputs scaled to [-1, 1], as the file describes them."""
    angle, (low, high) = states[:, 0], file.scaling.speed_rad_s
    waves = [wave(k * angle) for k in range(1, file.harmonics + 1) for wave in (np.sin, np.cos)] or [angle / np.pi - 1]
    inputs = np.column_stack([*waves, 2 * (states[:, 1] - low) / (high - low) - 1])
    hidden, output = np.array(file.hidden), np.array(file.output)
    bent = 2.0 / (1.0 + np.exp(-2.0 * (inputs @ hidden[:, :-1].T + hidden[:, -1]))) - 1.0
    scaled = bent @ output[:, :-1].T + output[:, -1]
    limits = np.array([file.scaling.dry_n_m, file.scaling.wet_n_m])
    torques: Floats = limits[:, 0] + 0.5 * (scaled + 1.0) * (limits[:, 1] - limits[:, 0])
    return torques


@pytest.mark.parametrize("harmonics", [0, 1, 2])
def test_the_row_of_numbers_gives_what_the_file_describes(harmonics: int) -> None:
    file = random_file(harmonics)
    for column, wet in enumerate((False, True)):
        torques = np.empty(len(STATES))
        network_torques(file.numbers(), wet, STATES, torques)
        assert torques == pytest.approx(textbook(file, STATES)[:, column], rel=1e-12, abs=1e-11)


@pytest.mark.parametrize("harmonics", [0, 1, 2])
def test_the_tangent_is_that_of_differences(harmonics: int) -> None:
    numbers, step = random_file(harmonics).numbers(), 1e-5
    for angle, speed in STATES[::50]:
        here = network_tangent(numbers, angle, speed, True)
        ahead, behind = (network_tangent(numbers, angle + s, speed, True).torque_n_m for s in (step, -step))
        assert here.by_angle == pytest.approx((ahead - behind) / (2 * step), rel=1e-6, abs=1e-6)
        ahead, behind = (network_tangent(numbers, angle, speed + s, True).torque_n_m for s in (step, -step))
        assert here.by_speed == pytest.approx((ahead - behind) / (2 * step), rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("wet", [False, True])
def test_c_gives_the_same_numbers(wet: bool) -> None:
    numbers = random_file(2).numbers()
    ours, theirs = np.empty((2, len(STATES), 3))
    network_tangents(numbers, wet, STATES, ours)
    compile_network()(numbers, wet, STATES, theirs)
    assert ours.tobytes() == theirs.tobytes()
    assert np.ptp(ours[:, 0]) > 1.0
