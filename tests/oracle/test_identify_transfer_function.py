"""Stage 1 against what it does not share: scipy's simulation, a direct output-error fit, and repeated noise."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares
from scipy.signal import lsim

from hilplant.bench import load_bench
from hilplant.failure import Failure
from hilplant.identify.first_stage import first_stage
from hilplant.identify.sequence_runs import stages_of, write_scenario
from hilplant.identify.srivc import Stretch, _searched, fit, simulated
from hilplant.identify.transfer_function import (
    Coefficients,
    Equivalent,
    TransferFunction,
    by_constant,
    by_load,
    coefficients,
    load_constant,
    of_motor,
    transfer_function,
)  # fmt: skip
from hilplant.measurements.checks import examine
from hilplant.measurements.files import Origin
from hilplant.measurements.measurement import Measurement
from hilplant.measurements.preparation import read_measurement
from hilplant.simulation.run import simulate

MOTOR = Equivalent(1.17, 2.9e-3, 0.044, 2.4e-5, 2.2e-4)
PERIOD_S = 1e-3


def steps(seconds: float, seed: int = 0) -> np.ndarray:
    random = np.random.default_rng(seed)
    return np.repeat(random.uniform(8.0, 16.0, round(seconds / 0.25)), 250)


def exact(volts: np.ndarray, motor: Equivalent = MOTOR, period_s: float = PERIOD_S) -> np.ndarray:
    """The current by scipy's simulation of (5.2) in state space: the voltage held between samples, start at rest."""
    r, inductance, k, j, drag = motor
    a = np.array([[-r / inductance, -k / inductance], [k / j, -drag / j]])
    system = (a, np.array([[1.0 / inductance], [0.0]]), np.array([[1.0, 0.0]]), np.array([[0.0]]))
    return lsim(system, volts, np.arange(len(volts)) * period_s, interp=False)[1]


def whole(volts: np.ndarray, current: np.ndarray) -> Stretch:
    return Stretch(volts, current, np.ones(len(volts), bool))


def test_the_transfer_function_answers_as_the_motor_equations_do() -> None:
    """(5.7) against an adaptive integration of (5.2) over one step of 12 V."""
    r, inductance, k, j, drag = MOTOR

    def rates(_: float, x: np.ndarray) -> list[float]:
        return [(12.0 - r * x[0] - k * x[1]) / inductance, (k * x[0] - drag * x[1]) / j]

    times = np.arange(200) * PERIOD_S
    solved = solve_ivp(rates, (0.0, times[-1]), [0.0, 0.0], "LSODA", times, rtol=1e-10, atol=1e-12).y[0]
    assert np.allclose(simulated(of_motor(MOTOR), np.full(200, 12.0), PERIOD_S), solved, atol=1e-7)


def test_the_ways_between_motor_coefficients_and_function_are_inverse() -> None:
    function = of_motor(MOTOR)
    assert transfer_function(coefficients(function)) == pytest.approx(function, rel=1e-12)
    assert by_load(coefficients(function), MOTOR.drag_n_m_s) == pytest.approx(MOTOR, rel=1e-9)
    assert by_constant(coefficients(function), MOTOR.constant_v_s) == pytest.approx(MOTOR, rel=1e-9)


def test_gamma_of_5_15() -> None:
    assert load_constant() == pytest.approx(3.0 / (63.0 * 126.0 * math.pi), rel=1e-12)


def test_data_without_noise_give_the_motor_back() -> None:
    volts = steps(3.0)
    found = fit([whole(volts, exact(volts))], PERIOD_S)
    assert found.function == pytest.approx(of_motor(MOTOR), rel=1e-6)


def test_the_estimate_equals_a_direct_output_error_fit() -> None:
    """Nonlinear least squares over scipy's simulation, the start's state free: another method, and the same optimum."""
    volts = steps(4.0)
    current = exact(volts) + 0.1 * np.random.default_rng(5).standard_normal(len(volts))
    found = fit([whole(volts, current)], PERIOD_S)
    start, times = np.array(of_motor(MOTOR)), np.arange(len(volts)) * PERIOD_S

    def misfit(x: np.ndarray) -> np.ndarray:
        b1, b0, a1, a0 = x[:4] * start
        system = ([[-a1, -a0], [1.0, 0.0]], [[1.0], [0.0]], [[b1, b0]], [[0.0]])
        return lsim(system, volts, times, X0=x[4:] * [1e-3, 1e-5], interp=False)[1] - current

    direct = least_squares(misfit, [1.02, 1.02, 1.02, 1.02, 0.0, 0.0], xtol=1e-12, ftol=1e-12).x[:4] * start
    errors = np.sqrt(np.diag(found.covariance))
    assert np.all(np.abs(np.array(found.function) - direct) < 0.01 * errors)


def test_noise_does_not_bend_the_estimate_as_it_bends_plain_least_squares() -> None:
    """The mean over sixteen noises is within three of its standard errors; the stated errors are of the right size."""
    volts = steps(3.0)
    clean, truth = exact(volts), np.array(of_motor(MOTOR))
    found, stated = [], []
    for seed in range(16):
        noise = 0.1 * np.random.default_rng(seed).standard_normal(len(volts))
        made = fit([whole(volts, clean + noise)], PERIOD_S)
        found.append(made.function)
        stated.append(np.sqrt(np.diag(made.covariance)))
    spread = np.std(found, axis=0, ddof=1)
    assert np.all(np.abs(np.mean(found, axis=0) - truth) < 3.0 * spread / math.sqrt(16))
    assert np.all((np.mean(stated, axis=0) / spread > 0.6) & (np.mean(stated, axis=0) / spread < 2.0))


def test_a_start_in_full_motion_and_a_constant_torque_are_allowed_for() -> None:
    """Two stretches cut out of a run against an extra dry torque: the answer of (5.2) to it is a third coefficient."""
    volts = steps(4.0)
    _, inductance, k, j, _ = MOTOR
    torque = 0.04
    effect = k * torque / (inductance * j)
    b = of_motor(MOTOR)
    times = np.arange(len(volts)) * PERIOD_S
    current = exact(volts) + lsim(([effect], [1.0, b.a1, b.a0]), np.ones(len(volts)), times, interp=False)[1]
    parts = [whole(volts[cut], current[cut]) for cut in (slice(130, 1700), slice(2111, 4000))]
    found = fit(parts, PERIOD_S, friction=True)
    assert found.function == pytest.approx(b, rel=1e-5)
    assert found.friction == pytest.approx(effect, rel=1e-5)


def test_samples_that_do_not_count_change_nothing() -> None:
    volts = steps(3.0)
    current = exact(volts) + 0.05 * np.random.default_rng(1).standard_normal(len(volts))
    valid = np.ones(len(volts), bool)
    valid[[400, 900, 1501]] = False
    bridged = np.where(valid, current, np.interp(np.arange(len(volts)), np.flatnonzero(valid), current[valid]))
    one, two = fit([Stretch(volts, bridged, valid)], PERIOD_S), fit([whole(volts, current)], PERIOD_S)
    errors = np.sqrt(np.diag(two.covariance))
    assert np.all(np.abs(np.array(one.function) - np.array(two.function)) < 0.5 * errors)


def test_a_constant_voltage_and_current_are_refused() -> None:
    with pytest.raises(Failure, match=r"cannot be told|does not settle"):
        fit([whole(np.full(2000, 12.0), np.full(2000, 3.0))], PERIOD_S)


def wiper(motor: Equivalent, fast: bool, seed: int, ripple: float = 0.015) -> Measurement:
    """A motor with 0.03 N m dry torque and a `ripple` load over the crank angle, by an explicit method at 50 us.

    The current has 0.1 A noise and steps of 10 mA.
    """
    r, inductance, k, j, drag = motor
    current = speed = turned = 0.0
    volts = np.repeat([0.0, 10.0, 12.0, 14.0, 16.0, 12.0], 2000)
    rows = np.empty((len(volts), 2))
    for tick, voltage in enumerate(volts):
        rows[tick] = current, turned
        for _ in range(20):
            limit = 0.03 + ripple * math.sin(turned) ** 2
            load = limit if speed > 0.0 or k * current > limit else k * current
            current += 5e-5 * (voltage - r * current - k * speed) / inductance
            speed = max(0.0, speed + 5e-5 * (k * current - drag * speed - load) / j)
            turned += 5e-5 * speed / 63.0
    noisy = np.round((rows[:, 0] + 0.1 * np.random.default_rng(seed).standard_normal(len(volts))) / 0.01) * 0.01
    park = (np.cos(rows[:, 1]) > 0.9925).astype(float)
    count = len(volts)
    modes = np.full(count, float(fast))
    return Measurement(np.arange(count) * 1e-3, volts, noisy, park, modes, np.ones(count, bool), 1e-3, "wiper.csv")


@pytest.mark.parametrize(
    ("fast", "motor"),
    [(False, Equivalent(1.17, 2.9e-3, 0.044, 2.4e-5, 1e-4)), (True, Equivalent(0.75, 3.0e-3, 0.031, 2.4e-5, 1e-4))],
)
@pytest.mark.parametrize("ripple", [0.0, 0.015])
def test_voltage_current_and_park_switch_give_the_motor(fast: bool, motor: Equivalent, ripple: float) -> None:
    """Resistance, inductance, constant, inertia from the three channels of a rig that shares nothing with the plant.

    The published first stage was off by factors of two to six.
    """
    found = first_stage(wiper(motor, fast, 1, ripple), 63.0)["fast" if fast else "slow"]
    assert found.by_park is not None and found.load is not None
    parts = [value.n / truth - 1.0 for value, truth in zip(found.by_park[:4], motor[:4], strict=True)]
    assert np.all(np.abs(parts) < [0.05, 0.09, 0.01, 0.16 if ripple else 0.05]), parts
    assert found.load.coulomb_torque_n_m.n == pytest.approx(0.03 + 0.5 * ripple, rel=0.2)
    assert found.turns > 4


def test_the_search_finds_what_the_rounds_find() -> None:
    """Where both work; it is the search that is left when the rounds go in circles."""
    volts = steps(2.0)
    current = exact(volts) + 0.1 * np.random.default_rng(5).standard_normal(len(volts))
    by_rounds = fit([whole(volts, current)], PERIOD_S)
    a1, a0, b1, b0 = _searched([whole(volts, current)], PERIOD_S, False)[:4]
    errors = np.sqrt(np.diag(by_rounds.covariance))
    assert np.all(np.abs(np.array(by_rounds.function) - [b1, b0, a1, a0]) < 0.02 * errors)


@pytest.mark.parametrize(
    ("kind", "most"), [("figure-5-4", (0.08, 0.10, 0.05, 0.15)), ("informative", (0.03, 0.05, 0.015, 0.07))]
)
def test_the_default_bench_is_found_from_either_sequence(tmp_path: Path, kind: str, most: tuple[float, ...]) -> None:
    """Table 5-9 under the plant's whole load, both modes; starts from rest tell more than Figure 5-4."""
    out = tmp_path / "sequence.yaml"
    write_scenario("default", stages_of(kind, "10,12,14,16"), out)
    simulate("default", out).write(tmp_path / "data.parquet")
    data = read_measurement(Origin(tmp_path / "data.parquet"))
    assert [finding for finding in examine(data) if finding.fatal] == []
    current = data.current_a + 0.1 * np.random.default_rng(0).standard_normal(len(data))
    motor = load_bench("default").parameters.motor
    for mode, found in first_stage(replace(data, current_a=np.round(current, 2)), motor.gear_ratio).items():
        assert found.by_park is not None
        truth = (*getattr(motor, mode), motor.inertia_kg_m2)
        parts = [value.n / wanted - 1.0 for value, wanted in zip(found.by_park[:4], truth, strict=True)]
        assert np.all(np.abs(parts) < most), (mode, parts)


def test_an_unknown_mode_is_asked_for() -> None:
    data = wiper(MOTOR, False, 1)
    data.fast[:] = np.nan
    with pytest.raises(Failure, match="slow or fast"):
        first_stage(data, 63.0)


def test_the_names_of_the_coefficients_are_those_of_table_5_1() -> None:
    """Units and definitions: K_sys = 1/L, t_elec = L/R, t_mech = R J/K^2, t_r = (b + gamma)/J."""
    r, inductance, k, j, drag = MOTOR
    wanted = Coefficients(1.0 / inductance, inductance / r, r * j / k**2, drag / j)
    assert coefficients(TransferFunction(*of_motor(MOTOR))) == pytest.approx(wanted, rel=1e-9)
