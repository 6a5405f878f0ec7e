"""Stall, a blade frozen to the glass, a dry screen and a lifted blade do to the default bench what physics says."""

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.signals import INPUT_INDEX
from hilplant.simulation.entries import Entry
from hilplant.simulation.run import Result, simulate
from hilplant.simulation.scenario import Scenario

BENCH = load_bench("default")
SLOW = BENCH.parameters.motor.slow


def wipe(seconds: float = 6.0, **signals: list[tuple[float, float]]) -> Result:
    """Run slowly on a wet screen; the signals that are named have other values from the times given on."""
    given = {"relay_on": [(0.0, 1.0)], "screen": [(0.0, 1.0)]} | signals
    entries = {INPUT_INDEX[name]: tuple(Entry(*entry) for entry in entries) for name, entries in given.items()}
    return simulate(BENCH, Scenario(seconds, {}, entries))


def mean(result: Result, name: str, start_s: float, end_s: float) -> float:
    return float(result[name][(result.time_s >= start_s) & (result.time_s < end_s)].mean())


def test_a_blocked_crank_stands_and_the_current_is_that_of_the_resistance_alone() -> None:
    run = wipe(brake_torque_n_m=[(0.0, 0.0), (2.0, 1000.0), (4.0, 0.0)])
    stalled = (run.time_s > 2.5) & (run.time_s < 4.0)
    assert np.all(run["motor_speed_rad_s"][stalled] == 0.0)
    assert run["current_a"][stalled] == pytest.approx(13.5 / SLOW.resistance_ohm, rel=1e-9)
    assert mean(run, "crank_speed_rad_s", 5.0, 6.0) > 3.0


def test_a_blade_frozen_to_the_glass_stalls_both_and_lets_go_when_it_thaws() -> None:
    run = wipe(left_wear=[(0.0, 1.0), (0.5, 100.0), (2.0, 1.0)])
    frozen = (run.time_s > 1.0) & (run.time_s < 2.0)
    assert np.sin(run["crank_angle_rad"][frozen]).min() > 0.5, "far from the dead centres"
    assert np.ptp(run["right_arm_rad"][frozen]) < 1e-12
    assert run["current_a"][frozen] == pytest.approx(13.5 / SLOW.resistance_ohm, rel=1e-9)
    assert mean(run, "crank_speed_rad_s", 3.0, 6.0) > 3.0


def test_a_screen_that_dries_takes_more_current_and_speed() -> None:
    run = wipe(12.0, screen=[(0.0, 1.0), (6.0, 0.0)])
    wet_a, dry_a = mean(run, "current_a", 2.0, 6.0), mean(run, "current_a", 7.0, 12.0)
    wet, dry = (mean(run, "crank_speed_rad_s", *span) for span in ((2.0, 6.0), (7.0, 12.0)))
    assert dry_a > 2.0 * wet_a
    assert 0.5 * wet < dry < 0.9 * wet


def test_friction_balances_the_motor_over_a_steady_run_on_a_dry_screen() -> None:
    """Over whole turns the mean torque of the motor, less its damping, is the mean load at the crank over the ratio."""
    run = wipe(12.0, screen=[(0.0, 0.0)])
    turned = np.unwrap(run["crank_angle_rad"])
    whole = (turned > turned[2000]) & (turned <= turned[2000] + 3 * 2.0 * np.pi)
    motor = BENCH.parameters.motor
    driven = SLOW.constant_v_s * run["current_a"][whole] - motor.damping_n_m_s * run["motor_speed_rad_s"][whole]
    load = np.maximum(run["load_torque_n_m"][whole], 0.0) / motor.gear_ratio
    assert driven.mean() == pytest.approx(load.mean(), rel=0.01)


def test_a_wind_that_lifts_the_blades_off_the_screen_leaves_no_friction() -> None:
    run = wipe(4.0, vehicle_speed_m_s=[(0.0, 100.0)])
    assert np.all(run["left_force_n"] == 0.0)
    assert np.all(run["right_force_n"] == 0.0)


def test_a_brown_out_on_a_dry_screen_stalls_the_wiper_and_it_goes_on_when_the_supply_is_back() -> None:
    run = wipe(8.0, screen=[(0.0, 0.0)], supply_v=[(0.0, 13.5), (3.0, 3.0), (5.0, 13.5)])
    low = (run.time_s > 4.5) & (run.time_s < 5.0)
    assert np.all(run["motor_speed_rad_s"][low] == 0.0)
    assert run["current_a"][low] == pytest.approx(3.0 / SLOW.resistance_ohm, rel=1e-9)
    assert mean(run, "crank_speed_rad_s", 6.0, 8.0) > 1.5
