"""Stage 1 on rigs with few steps, dry friction, noise and rounding: intervals that hold, or a reason in one line.

The rigs are simulated here, apart from the plant: exact current between fine steps, dry friction that holds a shaft at
rest.
"""

import math
import warnings

import numba
import numpy as np
import pytest
from scipy.stats import chi2

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.identify.breakaway import torque_part
from hilplant.identify.first_stage import first_stage
from hilplant.measurements.checks import examine
from hilplant.measurements.measurement import Channel, Measurement
from hilplant.measurements.preparation import Preparation, prepare
from hilplant.motor_bench.bench_measurements import quantity

R, L, K, GEAR = 1.0, 2.0e-3, 0.04, 63.0
FINE = 8


@numba.njit
def driven(voltage: Floats, torques: tuple[float, float], angle: float) -> Floats:
    """Return current [A] and park contact at each millisecond of the voltage, from rest at an angle of the crank."""
    coulomb, load = torques
    step_s, inertia = 1e-3 / FINE, 2e-5
    decay = math.exp(-step_s * R / L)
    current = speed = 0.0
    rows = np.zeros((len(voltage), 2))
    for tick, volt in enumerate(voltage):
        rows[tick, 0], rows[tick, 1] = current, angle % (2.0 * math.pi) < 0.12
        torque = coulomb + load * (1.0 + math.sin(2.0 * angle))
        for _ in range(FINE):
            settled = (volt - K * speed) / R
            current = settled + (current - settled) * decay
            drive = K * current - 1e-5 * speed
            held = speed <= 0.0 and drive < torque
            speed = 0.0 if held else max(0.0, speed + step_s * (drive - torque) / inertia)
            angle += step_s * speed / GEAR
    return rows


def rig(seed: int, volts: tuple[float, ...], torques: tuple[float, float], noise: float, seconds: float) -> Measurement:
    """Simulate a motor that is stepped through `volts`; its load, beside dry friction, swings with the crank."""
    rng, count = np.random.default_rng(seed), round(1e3 * seconds)
    edges = np.linspace(0.5, seconds, len(volts) + 1) * 1e3
    voltage = np.zeros(count)
    for volt, begin, end in zip(volts, edges[:-1].astype(int), edges[1:].astype(int), strict=True):
        voltage[begin:end] = volt
    rows = driven(voltage, torques, float(rng.uniform(0.0, 6.28)))
    time_s = np.arange(count) * 1e-3
    measured = {
        "voltage": np.round(voltage + 0.02 * rng.standard_normal(count), 2),
        "current": np.round(rows[:, 0] + noise * rng.standard_normal(count), 2),
        "park": 12.0 * rows[:, 1],
    }
    channels = {name: Channel(time_s, values, "") for name, values in measured.items()}
    return prepare(channels, {}, Preparation(mode="slow", current_shift_s=None if seed % 4 == 3 else 0.0))


@pytest.mark.parametrize("seed", range(6))
def test_dry_friction_does_not_bend_resistance_and_inductance(seed: int) -> None:
    """A motor alone: without the hold at rest R came out 1 to 4 % high, up to nine standard errors."""
    volts = ((8.0, 10.0, 12.0), (6.0, 9.0, 12.0, 9.0), (12.0, 0.0, 10.0, 0.0, 14.0))[seed % 3]
    data = rig(seed, volts, (0.01 + 0.008 * seed, 0.0), noise=0.02, seconds=4.0)
    found = first_stage(data, GEAR)["slow"]
    for value, truth, most in ((found.by_load.resistance_ohm, R, 0.01), (found.by_load.inductance_henry, L, 0.02)):
        number = quantity(value)
        assert abs(number.n / truth - 1.0) < most
        assert abs(number.n - truth) < 3.5 * number.s


@pytest.mark.parametrize("noise_a", [0.01, 0.1])
def test_the_intervals_hold_what_is_true_also_where_the_voltage_is_noisy(noise_a: float) -> None:
    """Over rigs of all kinds the squares of error over standard error add up to what chi square allows (99.9 %).

    0.02 V of noise in the voltage is most of the error where the current is quiet. The sums are not too small either.
    """
    volts = ((8.0, 10.0, 12.0), (6.0, 9.0, 12.0, 9.0), (12.0, 0.0, 10.0, 0.0, 14.0))
    squares = []
    for seed in range(1, 13):
        data = rig(seed, volts[seed % 3], (0.012 + 0.003 * seed, 0.0), noise_a, seconds=4.0)
        try:
            found = first_stage(data, GEAR)["slow"].by_load
        except Failure:
            continue
        pairs = (quantity(found.resistance_ohm), R), (quantity(found.inductance_henry), L)
        squares.append([((value.n - truth) / value.s) ** 2 for value, truth in pairs])
    assert len(squares) >= 9
    assert np.all(np.sum(squares, axis=0) < chi2.ppf(0.999, len(squares)))
    assert np.all(np.sum(squares, axis=0) > chi2.ppf(0.001, len(squares)))


@pytest.mark.parametrize("seed", range(32))
def test_a_rig_with_few_steps_ends_in_numbers_or_a_reason(seed: int) -> None:
    """Never a warning of numpy, a LinAlgError or a number that is none."""
    rng = np.random.default_rng(seed)
    volts = ((12.0, 14.0, 16.0), (12.0,), (12.0, 14.0), (16.0, 14.0, 12.0), (13.0, 0.0, 13.0), (9.0,))[seed % 6]
    coulomb, load, noise = rng.uniform(0.0, 0.1), rng.uniform(0.0, 0.1), float(rng.choice([0.0, 0.02, 0.1, 0.5]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            data = rig(seed, volts, (coulomb, load), noise, seconds=1.8)
            examine(data)
            found = first_stage(data, GEAR)["slow"]
        except Failure as error:
            assert "\n" not in str(error)
            assert len(str(error)) > 30
            return
    for value in found.by_park or found.by_load:
        assert np.isfinite(quantity(value).n)
        assert quantity(value).s >= 0.0


@pytest.mark.parametrize("least_a", [0.5, 3.0, 11.0, 20.0])
def test_the_hold_at_rest_is_the_mean_of_what_the_current_makes(least_a: float) -> None:
    """Against the same by fine steps; a current that never suffices holds for ever."""
    stiffness, b1 = K * K / (L * 2e-5), 1.0 / L
    theta = np.array([R / L, stiffness, b1, 0.0, least_a * stiffness])
    voltage = np.concatenate([np.zeros(10), np.full(40, 12.0)])
    fine_s = np.arange(0.0, 0.04, 1e-6)
    held = np.minimum(12.0 / R * (1.0 - np.exp(-fine_s * R / L)) / least_a, 1.0).reshape(40, -1).mean(axis=1)
    assert np.allclose(torque_part(voltage, 10, 1e-3, theta), np.concatenate([np.zeros(10), held]), atol=1e-3)
    assert np.array_equal(torque_part(voltage, 0, 1e-3, theta), np.ones(50))
    assert np.array_equal(torque_part(voltage, 10, 1e-3, None), np.repeat([0.0, 1.0], [10, 40]))
