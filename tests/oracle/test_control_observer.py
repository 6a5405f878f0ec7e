"""Observer and network against other methods: an ODE solver and numpy."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hilplant.bench import load_bench
from hilplant.control.catalogue import BLIND_NOISE
from hilplant.control.closed_loop import observe_rows
from hilplant.control.design import ObserverNoise, armature, model
from hilplant.control.network import network_speed
from hilplant.control.observer import correct, learn_resistance, predict
from hilplant.control.records import AT_REST, Measured, SpeedEstimate
from hilplant.train.speed_network import train, training_record
from hilplant.units import TURN_RAD

BENCH = load_bench("default")
MOTOR = BENCH.parameters.motor
PERIOD_S = 0.001


def solved(voltage: float, torque: float, state: tuple[float, float], seconds: float) -> np.ndarray:
    """Current and motor speed by (3.30), (3.31) with a constant load torque, by an adaptive solver."""
    brush = MOTOR.slow

    def rates(_, x):
        i, w = x
        back = brush.constant_v_s * w
        return [
            (voltage - brush.resistance_ohm * i - back) / brush.inductance_henry,
            (brush.constant_v_s * i - MOTOR.damping_n_m_s * w - torque) / MOTOR.inertia_kg_m2,
        ]

    return solve_ivp(rates, (0.0, seconds), state, rtol=1e-10, atol=1e-12).y[:, -1]


@pytest.mark.parametrize(("voltage", "torque"), [(12.0, 0.1), (20.0, 0.0), (5.0, 0.05)])
def test_a_prediction_is_the_motor_s_own_motion(voltage, torque):
    believed = model(armature(MOTOR, False), PERIOD_S, ObserverNoise(), True)
    ahead = predict(SpeedEstimate(2.0, 150.0, torque), voltage, believed, PERIOD_S)
    assert (ahead.current_a, ahead.motor_speed_rad_s) == pytest.approx(
        tuple(solved(voltage, torque, (2.0, 150.0), PERIOD_S)), rel=1e-9
    )
    assert ahead.torque_n_m == torque


def test_the_observer_finds_speed_and_load_torque_from_the_current_alone():
    believed = model(armature(MOTOR, False), PERIOD_S, BLIND_NOISE, False)
    state, estimate = np.array([2.0, 150.0]), AT_REST
    for _ in range(400):
        estimate = correct(estimate, Measured(0.0, float(state[0]), 0.0), believed)
        estimate = predict(estimate, 12.0, believed, PERIOD_S)
        state = solved(12.0, 0.08, tuple(state), PERIOD_S)
    assert estimate.motor_speed_rad_s == pytest.approx(state[1], rel=1e-4)
    assert estimate.torque_n_m == pytest.approx(0.08, rel=1e-3)


def test_kalman_gains_are_those_of_a_filter_that_has_run_for_long():
    """The covariance recursion itself, without the Riccati equation's solver."""
    noise, a = ObserverNoise(), armature(MOTOR, False)
    o = model(a, PERIOD_S, noise, True).observer
    transition = np.array([[o.a11, o.a12, o.a13], [o.a21, o.a22, o.a23], [0.0, 0.0, 1.0]])
    from_voltage = np.array([o.b1, o.b2, 0.0]) * noise.voltage_v
    unknown = np.outer(from_voltage, from_voltage) + np.diag([1e-12, 1e-12, (noise.torque_rate * PERIOD_S) ** 2])
    measures, seen = np.eye(3)[:2], np.diag([noise.current_a**2, noise.speed_rad_s**2])
    covariance = np.eye(3)
    for _ in range(5000):
        gain = covariance @ measures.T @ np.linalg.inv(measures @ covariance @ measures.T + seen)
        covariance = transition @ (covariance - gain @ measures @ covariance) @ transition.T + unknown
    assert [o.current_1, o.current_2, o.current_3] == pytest.approx(list(gain[:, 0]), rel=1e-4)
    assert [o.speed_1, o.speed_2, o.speed_3] == pytest.approx(list(gain[:, 1]), rel=1e-4)


def test_a_turn_that_was_too_long_by_what_a_wrong_resistance_makes_of_it_corrects_it():
    """w = (V - R i)/K at a steady current: the turn's length tells the resistance exactly."""
    a = armature(MOTOR, False)
    current, true_ohm, voltage = 3.0, 1.2 * a.resistance_ohm, 12.0
    speed = (voltage - true_ohm * current) / a.constant_v_s / a.gear_ratio
    seconds = TURN_RAD / speed
    turned = (voltage - a.resistance_ohm * current) / a.constant_v_s / a.gear_ratio * seconds
    before = SpeedEstimate(current, 150.0, 0.1, 1.0, turned, current * seconds, 0.0)
    assert learn_resistance(before, 1.0, a, 1.0).resistance_factor == pytest.approx(1.2)
    assert learn_resistance(before, 1.0, a, 0.5).resistance_factor == pytest.approx(1.1)
    assert learn_resistance(before, 0.0, a, 1.0).resistance_factor == 1.0
    assert learn_resistance(before._replace(turned_rad=-1.0), 1.0, a, 1.0).resistance_factor == 1.0


def test_measurements_that_are_no_numbers_leave_the_observer_to_its_model():
    believed = model(armature(MOTOR, False), PERIOD_S, ObserverNoise(), True)
    before = SpeedEstimate(2.0, 150.0, 0.1)
    assert correct(before, Measured(math.nan, math.nan, 0.0), believed) == before
    rows = np.full((50, 3), math.nan)
    rows[:, 0] = 10.0
    speeds = np.empty(50)
    assert math.isfinite(observe_rows(believed, PERIOD_S, 0.5, rows, speeds).motor_speed_rad_s)


def test_the_network_in_the_loop_is_the_one_that_was_trained_and_it_has_learned():
    data = training_record(BENCH, fast=True)
    path = train(data, 8)
    assert path.shape == (11, 4)
    before = np.concatenate([[0.0], data.voltage_v[:-1]])
    ours = np.array([network_speed(v, i, path) for v, i in zip(before[::40], data.current_a[::40], strict=True)])
    x, y = (before[::40] - path[0, 0]) / path[0, 1], (data.current_a[::40] - path[1, 0]) / path[1, 1]
    by_numpy = np.tanh(np.outer(x, path[3:, 0]) + np.outer(y, path[3:, 1]) + path[3:, 2]) @ path[3:, 3] + path[0, 3]
    assert ours == pytest.approx(path[2, 0] + path[2, 1] * by_numpy, abs=1e-12)
    assert np.sqrt(np.mean((ours - data.speed_rad_s[::40]) ** 2)) < 0.1
    assert np.array_equal(train(data, 2), train(data, 2))
