"""Bench measurements and data sheets against motors with known numbers; stated errors against repeated readings."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from uncertainties import ufloat

from hilplant.failure import Failure
from hilplant.motor_bench.bench_measurements import (
    MotorFriction,
    SteadyRun,
    back_emf_constant,
    cylinder_inertia,
    decay,
    fall_time,
    inductance,
    mean_of,
    no_load_friction,
    resistance,
    run_down,
    shaft_speed,
)  # fmt: skip
from hilplant.motor_bench.data_sheet import SpeedSheet, from_sheet, with_error

R, L, K, J, B, T = 1.17, 2.9e-3, 0.0442, 2.4e-5, 1.0e-4, 0.045


def steady(volts: float, ohm: float = R, constant: float = K) -> SteadyRun:
    """Solve V = R i + K w and K i = B w + T for a motor without a load."""
    current, speed = np.linalg.solve([[ohm, constant], [constant, -B]], [volts, T])
    return SteadyRun(volts, float(current), float(speed))


def test_the_cylinder_of_5_21() -> None:
    assert cylinder_inertia(0.275, 0.02).n == pytest.approx(5.5e-5, rel=1e-12)


def test_resistance_and_its_error_from_three_readings() -> None:
    found = resistance([(2.0, 2.0 / 1.16), (3.0, 3.0 / 1.17), (4.0, 4.0 / 1.18)])
    assert found.n == pytest.approx(1.17) and found.s == pytest.approx(0.01 / math.sqrt(3))


def test_a_meter_error_is_carried_on() -> None:
    """(V - R I)/w to first order by hand."""
    found = back_emf_constant(SteadyRun(12.0, ufloat(1.5, 0.03), 240.0), ufloat(1.0, 0.05))
    assert found.n == pytest.approx(10.5 / 240.0)
    assert found.s == pytest.approx(math.hypot(1.0 * 0.03, 1.5 * 0.05) / 240.0)


def test_the_stated_error_of_a_mean_is_the_spread_of_such_means() -> None:
    random = np.random.default_rng(4)
    means = [mean_of([float(x) for x in 5.0 + 0.2 * random.standard_normal(6)]) for _ in range(400)]
    assert np.sqrt(np.mean([each.s**2 for each in means])) == pytest.approx(np.std([each.n for each in means]), rel=0.1)


def test_park_edges_give_the_shaft_speed() -> None:
    assert shaft_speed(10, ufloat(12.0, 0.012), 63.0).n == pytest.approx(2.0 * math.pi * 63.0 * 10.0 / 12.0)
    assert shaft_speed(10, ufloat(12.0, 0.012), 63.0).s == pytest.approx(0.001 * 2.0 * math.pi * 63.0 * 10.0 / 12.0)


def blocked(noise: float, seed: int = 0, period_s: float = 1e-4) -> tuple[np.ndarray, np.ndarray]:
    """A blocked motor at 5 V whose supply falls to 0 at 0.1 s."""
    time_s = np.arange(1300) * period_s
    current = 5.0 / R * np.exp(-np.maximum(time_s - 0.1, 0.0) * R / L)
    return time_s, current + noise * np.random.default_rng(seed).standard_normal(len(time_s))


def test_inductance_from_the_fall_to_36_8_percent_as_the_thesis_reads_it() -> None:
    time_s, current = blocked(0.0)
    assert inductance(fall_time(time_s, current, 0.1), R).n == pytest.approx(L, rel=1e-3)


def test_inductance_from_the_whole_decay_and_its_error() -> None:
    """Forty noises: no bias, and the stated error is the spread."""
    found = []
    for seed in range(40):
        time_s, current = blocked(0.1, seed)
        after = time_s >= 0.1
        found.append(inductance(decay(time_s[after], current[after])[0], R))
    values = np.array([each.n for each in found])
    assert np.mean(values) == pytest.approx(L, abs=3.0 * np.std(values) / math.sqrt(40))
    assert np.mean([each.s for each in found]) == pytest.approx(np.std(values), rel=0.3)


def test_a_current_that_does_not_decay_is_refused() -> None:
    time_s = np.arange(200) * 1e-4
    with pytest.raises(Failure, match="no exponential decay"):
        decay(time_s, 4.0 + 0.1 * np.random.default_rng(1).standard_normal(200))
    with pytest.raises(Failure, match=r"36\.8"):
        fall_time(time_s, np.full(200, 4.0), 0.01)


def test_damping_and_coulomb_torque_from_no_load_points() -> None:
    runs = [steady(volts) for volts in (8.0, 10.0, 12.0, 14.0, 16.0)]
    found = no_load_friction(runs, [K] * 5)
    assert found.damping_n_m_s.n == pytest.approx(B, rel=1e-6)
    assert found.coulomb_torque_n_m.n == pytest.approx(T, rel=1e-6)


def test_table_5_4_needs_the_dry_torque_that_the_published_motor_lacks() -> None:
    """0.04 to 0.05 N m and b near the published 1.084e-4, from five rows (errata: the 14 V slow row does not fit)."""
    slow = [SteadyRun(12, 1.450, 230.38), SteadyRun(16, 1.708, 316.56)]
    fast = [SteadyRun(12, 2.537, 322.96), SteadyRun(14, 2.785, 394.40), SteadyRun(16, 2.949, 466.78)]
    constants = [back_emf_constant(run, ohm) for runs, ohm in ((slow, 1.0), (fast, 0.8)) for run in runs]
    found = no_load_friction([*slow, *fast], constants)
    assert 0.035 < found.coulomb_torque_n_m.n < 0.06
    assert abs(found.damping_n_m_s.n - 1.084e-4) < 3.0 * found.damping_n_m_s.s


def test_inertia_from_a_run_down_that_another_solver_made() -> None:
    times = np.linspace(0.0, 0.1, 200)
    solved = solve_ivp(lambda _, w: [-(B * w[0] + T) / J], (0.0, 0.1), [260.0], t_eval=times, rtol=1e-9).y[0]
    noisy = solved + 0.5 * np.random.default_rng(2).standard_normal(200)
    exact = run_down(times, solved, MotorFriction(B, T))
    found = run_down(times, noisy, MotorFriction(ufloat(B, 0.02 * B), ufloat(T, 0.02 * T)))
    assert exact.n == pytest.approx(J, rel=1e-4)
    assert abs(found.n - J) < 3.0 * found.s
    assert 0.01 < found.s / J < 0.03  # the friction's two per cent govern


def test_a_run_down_that_does_not_slow_is_refused() -> None:
    with pytest.raises(Failure, match="does not fall"):
        run_down(np.linspace(0.0, 1.0, 50), np.full(50, 200.0), MotorFriction(B, T))


def sheet(ohm: float, constant: float, volts: float = 13.5, efficiency: float = 0.6) -> SpeedSheet:
    run = steady(volts, ohm, constant)
    stall = volts / ohm
    return SpeedSheet(volts, run.current_a, run.speed_rad_s / 63.0, stall, efficiency * 63.0 * (constant * stall - T))


def test_a_data_sheet_gives_the_motor_that_it_was_written_from() -> None:
    found = from_sheet(sheet(R, K), sheet(0.75, 0.0315), 63.0)
    assert found.slow_resistance_ohm.n == pytest.approx(R)
    assert found.fast_resistance_ohm.n == pytest.approx(0.75)
    assert found.slow_constant_v_s.n == pytest.approx(K)
    assert found.fast_constant_v_s.n == pytest.approx(0.0315)
    assert found.friction.damping_n_m_s.n == pytest.approx(B, rel=1e-6)
    assert found.friction.coulomb_torque_n_m.n == pytest.approx(T, rel=1e-6)
    assert found.gear_efficiency is not None and found.gear_efficiency.n == pytest.approx(0.6)
    assert "inertia_kg_m2" in found.unknown


def test_tolerances_of_a_sheet_become_errors_of_the_right_size() -> None:
    """Against drawing the sheet's numbers two thousand times."""
    exact, random = (sheet(R, K), sheet(0.75, 0.0315)), np.random.default_rng(7)
    marked = [SpeedSheet(s[0], *(with_error(value, 0.01) for value in s[1:])) for s in exact]
    stated = from_sheet(marked[0], marked[1], 63.0)
    drawn = []
    for _ in range(2000):
        pair = [SpeedSheet(s[0], *(value * (1.0 + 0.01 * random.standard_normal()) for value in s[1:])) for s in exact]
        ohms = [s.voltage_v / s.stall_current_a for s in pair]
        constants = [
            (s.voltage_v - ohm * s.no_load_current_a) / (63.0 * s.no_load_speed_rad_s)
            for s, ohm in zip(pair, ohms, strict=True)
        ]
        torques = [constant * s.no_load_current_a for s, constant in zip(pair, constants, strict=True)]
        speeds = [63.0 * s.no_load_speed_rad_s for s in pair]
        damping = (torques[1] - torques[0]) / (speeds[1] - speeds[0])
        drawn.append((ohms[0], constants[0], damping, torques[0] - damping * speeds[0]))
    spread = np.std(drawn, axis=0)
    found = (stated.slow_resistance_ohm, stated.slow_constant_v_s, *stated.friction)
    assert [each.s for each in found] == pytest.approx(spread, rel=0.1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"stall_current_a": 0.5}, "are they exchanged"),
        ({"no_load_speed_rad_s": -1.0}, "no_load_speed_rad_s must be above 0"),
        ({"stall_torque_n_m": 90.0}, "gear efficiency of"),
    ],
)
def test_a_sheet_that_contradicts_itself_is_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(Failure, match=message):
        from_sheet(sheet(R, K)._replace(**change), sheet(0.75, 0.0315), 63.0)


def test_exchanged_speeds_are_refused() -> None:
    with pytest.raises(Failure, match="fast speed"):
        from_sheet(sheet(0.75, 0.0315), sheet(R, K), 63.0)
