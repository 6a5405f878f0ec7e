"""The motor network against numpy, finite differences, and an adaptive solver of the motor's equations."""

import math
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp

from hilplant.bench import load_bench
from hilplant.bench.motor_network_file import QUANTITIES
from hilplant.models.narx import FAST_BRUSH, SLOW_BRUSH, Sample, path_of, predict
from hilplant.progress import ProgressReport
from hilplant.resources import shipped
from hilplant.train.motor_data import excitation, mean_torque, physical, recorded
from hilplant.train.motor_fit import ENDLESS, MotorFit, MotorScaling, first_weights, train_path
from hilplant.train.motor_loop import room_for, run
from hilplant.train.torque import one_thread

FILE = shipped("config", "surrogates") / "motor_default.yaml"
BRUSHES = {"slow": SLOW_BRUSH, "fast": FAST_BRUSH}


@pytest.fixture(scope="module")
def bench() -> Any:
    return load_bench("networks")


@pytest.fixture(scope="module")
def written() -> dict[str, Any]:
    return yaml.safe_load(FILE.read_text())


def by_numpy(path: dict[str, Any], values: np.ndarray) -> np.ndarray:
    """Scale, tanh, linear, unscale, as section 6.4 and Appendix F describe it."""
    ranges = np.array([path["range"][name] for name in QUANTITIES])
    low, high = ranges.T
    scaled = 2.0 * (values - np.tile(low, 2)) / np.tile(high - low, 2) - 1.0
    hidden = np.tanh(np.array(path["hidden_weights"]) @ scaled + path["hidden_biases"])
    answer = np.array(path["output_weights"]) @ hidden + path["output_biases"]
    return low[2:] + 0.5 * (answer + 1.0) * (high - low)[2:]


@pytest.mark.parametrize("brush", ["slow", "fast"])
def test_compiled_code_gives_what_the_file_says_and_its_slope_by_the_torque(bench, written, brush) -> None:
    networks, random = bench.parameters.networks, np.random.default_rng(3)
    low, high = np.array([written[brush]["range"][name] for name in QUANTITIES]).T
    for _ in range(50):
        now, before = random.uniform(low, high), random.uniform(low, high)
        index = path_of(networks, BRUSHES[brush])
        ours = predict(networks, index, Sample(*now), Sample(*before))
        assert ours[:2] == pytest.approx(by_numpy(written[brush], np.concatenate([now, before])), rel=1e-9, abs=1e-10)
        step = np.array([0.0, 1e-4, 0.0, 0.0])
        ends = [by_numpy(written[brush], np.concatenate([now + sign * step, before])) for sign in (1.0, -1.0)]
        assert ours[2:] == pytest.approx((ends[0] - ends[1]) / 2e-4, rel=1e-5, abs=1e-8)


@pytest.mark.parametrize("brush", ["slow", "fast"])
@pytest.mark.parametrize(("voltage", "torque"), [(13.5, 5.0), (9.0, 2.0), (17.0, 20.0)])
def test_left_alone_for_a_second_it_follows_an_adaptive_solver_of_the_equations_of_the_motor(
    bench, brush, voltage, torque
) -> None:
    """(3.30), (3.31) with a torque that is given: 1000 answers, each fed back, from the first two true states."""
    motor, networks = bench.parameters.motor, bench.parameters.networks
    ends, ratio = getattr(motor, brush), motor.gear_ratio

    def rates(_: float, y: np.ndarray) -> list[float]:
        current = (voltage - ends.resistance_ohm * y[0] - ends.constant_v_s * y[1]) / ends.inductance_henry
        pull = ends.constant_v_s * y[0] - motor.damping_n_m_s * y[1] - torque / ratio
        return [current, pull / motor.inertia_kg_m2]

    times = np.arange(1001) * 1e-3
    start = [8.0, 1.5 * ratio]
    true = solve_ivp(rates, (0.0, 1.0), start, "Radau", times, rtol=1e-9, atol=1e-9).y / [[1.0], [ratio]]
    index = path_of(networks, BRUSHES[brush])
    before, state = true[:, 0], true[:, 1]
    answers = [before, state]
    for _ in range(999):
        after = predict(networks, index, Sample(voltage, torque, *state), Sample(voltage, torque, *before))
        before, state = state, np.array(after[:2])
        answers.append(state)
    errors = np.abs(np.array(answers).T - true)
    assert errors[0].max() < 0.03, "A, of more than 10 A"
    assert errors[1].max() < 0.01, "rad/s"


@pytest.mark.parametrize("horizon", [1, 7, ENDLESS])
def test_derivatives_through_the_feedback_are_those_of_finite_differences(horizon) -> None:
    random, count = np.random.default_rng(5), 60
    inputs, outputs = random.uniform(-1.0, 1.0, (2, count, 2))
    earlier = outputs + 0.1
    known = random.random(count) < 0.9
    known[0] = False
    weights = first_weights(3, random)
    weights[27:33] *= 0.3

    def answers(at: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
        predicted = np.empty((count, 2))
        run(at, inputs, outputs, earlier, known, horizon, predicted, jacobian, np.zeros(room_for(len(at))))
        return predicted

    none, jacobian = np.zeros((0, 2, len(weights))), np.zeros((count, 2, len(weights)))
    answers(weights, jacobian)
    for index in range(len(weights)):
        step = np.zeros(len(weights))
        step[index] = 1e-6
        differences = (answers(weights + step, none) - answers(weights - step, none)) / 2e-6
        assert jacobian[1:, :, index] == pytest.approx(differences[1:], abs=2e-6), index


def test_the_torque_that_is_learnt_from_is_the_one_that_was_applied(bench) -> None:
    """A motor alone with a constant brake: what the balance over each tick leaves is that brake."""
    from hilplant.models.armature import ArmatureDrive, ArmatureMotion, glide

    parameters = physical(bench.parameters)
    motor, brush, torque = parameters.motor, parameters.motor.slow, 7.0
    drive = ArmatureDrive(12.0, *brush, motor.inertia_kg_m2, motor.damping_n_m_s, 0.0)
    motion, rows = ArmatureMotion(1.0, 80.0, 0.0), []
    for _ in range(50):
        rows.append(motion)
        motion = glide(motion, drive, torque / motor.gear_ratio, 1e-3)
    current, speed, turned = np.array(rows).T
    ratio = motor.gear_ratio
    found = mean_torque(np.full(50, 12.0), current, turned / ratio, speed / ratio, (parameters, brush))
    assert found == pytest.approx(np.full(49, torque), rel=1e-6)


def test_training_splits_by_time_and_reaches_all_there_is_to_learn(bench) -> None:
    sequence = recorded(bench, "slow", 16.0, np.random.default_rng([1, 0, 0]))
    training, validation, test = (np.flatnonzero(part) for part in sequence.parts())
    assert training[-1] < 11_200 <= validation[0] + 1
    assert validation[-1] < 13_600 <= test[0] + 1
    ranges = MotorScaling.of(sequence).ranges
    assert ranges[0, 0] == 0.0
    assert ranges[0, 1] > 18.2
    assert ranges[2, 0] < -5.0 < 10.0 < ranges[2, 1]


def test_a_short_training_repeats_to_the_last_bit_and_an_interrupt_keeps_the_best(bench) -> None:
    sequence = recorded(bench, "fast", 1.5, np.random.default_rng(2))
    told: list[float] = []

    def stop_in_the_sixth_epoch(seen: ProgressReport) -> None:
        told.append(float(seen.note.split()[-1]))
        if seen.done == 6:
            raise KeyboardInterrupt

    with one_thread():
        runs = [train_path("fast", sequence, np.random.default_rng(4), stop_in_the_sixth_epoch) for _ in range(2)]
    assert runs[0].weights.tobytes() == runs[1].weights.tobytes()
    assert runs[0].interrupted
    assert runs[0].epochs == (6, 0)
    assert told[:6] == told[6:]
    fit = MotorFit(sequence, runs[0].scaling, 1)
    assert fit.judged(runs[0].weights) < 0.5 * told[0], "the best so far, not the first"
    assert math.isfinite(fit.cost(runs[0].weights))


def test_the_excitation_stays_in_the_range_that_it_promises(bench) -> None:
    rows = excitation(bench, "slow", 16.0, np.random.default_rng(1))
    assert rows.shape == (16_000, len(bench.input_row))
    assert 0.0 <= rows[:, 2].min() < 2.0
    assert 18.2 < rows[:, 2].max() <= 18.5
