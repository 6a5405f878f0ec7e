"""Cases of the motor that have an answer on paper: no-load speed, blocked rotor, coasting, break-away."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

from hilplant.models.armature import ArmatureDrive, ArmatureMotion
from hilplant.models.motor import advance, instant_of_zero
from hilplant.models.records import Brush, Motor

MOTORS = Path(__file__).parents[2] / "config" / "motors"
NAMES = ("table_3_1", "table_5_6", "table_5_8", "table_5_9", "figure_8_3")


def motor_of(name: str) -> Motor:
    text = yaml.safe_load((MOTORS / f"{name}.yaml").read_text())
    rest = ("inertia_kg_m2", "damping_n_m_s", "coulomb_torque_n_m", "gear_ratio")
    return Motor(Brush(**text["slow"]), Brush(**text["fast"]), *(text[key] for key in rest))


def drive_of(brush: Brush, motor: Motor, voltage: float, dry_torque: float) -> ArmatureDrive:
    return ArmatureDrive(voltage, *brush, motor.inertia_kg_m2, motor.damping_n_m_s, dry_torque)


@pytest.mark.parametrize("name", NAMES)
def test_the_motor_settles_at_the_no_load_speed_of_its_equations(name: str) -> None:
    motor = motor_of(name)
    for brush in (motor.slow, motor.fast):
        r, k, b = brush.resistance_ohm, brush.constant_v_s, motor.damping_n_m_s
        dry = 0.1 * k * 13.5 / r
        drive = drive_of(brush, motor, 13.5, dry)
        motion = ArmatureMotion(0.0, 0.0, 0.0)
        for _ in range(5000):
            motion = advance(motion, drive, 1e-3)
        assert motion.speed == pytest.approx((13.5 * k - r * dry) / (r * b + k * k), rel=1e-12)
        assert motion.current == pytest.approx((13.5 * b + k * dry) / (r * b + k * k), rel=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_a_blocked_motor_is_a_coil_with_a_resistor(name: str) -> None:
    motor = motor_of(name)
    brush = motor.slow
    motion = ArmatureMotion(0.0, 0.0, 0.0)
    for tick in range(1, 30):
        motion = advance(motion, drive_of(brush, motor, 13.5, 1e3), 1e-3)
        rise = -math.expm1(-tick * 1e-3 * brush.resistance_ohm / brush.inductance_henry)
        assert motion.current == pytest.approx(13.5 / brush.resistance_ohm * rise, rel=1e-12)
        assert motion.speed == 0.0
        assert motion.turned == 0.0


def by_solver(motion: ArmatureMotion, drive: ArmatureDrive, duration: float) -> np.ndarray:
    """Current, speed and angle by scipy, from zero to zero of the speed; for a shaft that never sticks."""

    def rates(sign: float) -> Callable[[float, np.ndarray], list[float]]:
        def of(_time: float, at: np.ndarray) -> list[float]:
            torque = drive.constant * at[0] - drive.damping * at[1] - sign * drive.dry_torque
            voltage = drive.voltage - drive.resistance * at[0] - drive.constant * at[1]
            return [voltage / drive.inductance, torque / drive.inertia, at[1]]

        return of

    def zero(_time: float, at: np.ndarray) -> float:
        return float(at[1])

    zero.terminal = True  # type: ignore[attr-defined]
    at, now, sign = np.array(motion), 0.0, math.copysign(1.0, motion.speed)
    while now < duration:
        found = solve_ivp(
            rates(sign), (now, duration), at, "DOP853", events=zero, rtol=1e-12, atol=1e-12, max_step=2e-3
        )
        at, now, sign = found.y[:, -1], float(found.t[-1]), -sign
        if now < duration:
            assert drive.constant * at[0] * sign > drive.dry_torque, "it would stick"
            at[1] = 1e-12 * sign
    return at


@pytest.mark.parametrize("duration", [0.2, 0.45, 0.7, 0.95])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_swing_through_zero_in_its_second_half_is_not_missed_however_long_the_step(
    duration: float, way: float
) -> None:
    drive = ArmatureDrive(way * 0.5, 0.1, 0.05, 0.2, 4e-3, 0.0, 0.02)  # a coil so large that the speed swings
    start = ArmatureMotion(way * 2.5, way * 1.5, 0.0)
    expected = by_solver(start, drive, duration)
    assert np.array(advance(start, drive, duration)) == pytest.approx(expected, abs=1e-8)


def test_it_breaks_away_at_the_instant_of_the_logarithm() -> None:
    motor = motor_of("table_5_9")
    brush, dry = motor.slow, 0.1
    i_break, i_final = dry / brush.constant_v_s, 13.5 / brush.resistance_ohm
    instant = -brush.inductance_henry / brush.resistance_ohm * math.log(1.0 - i_break / i_final)
    assert 0.0 < instant < 1e-3
    drive = drive_of(brush, motor, 13.5, dry)
    assert advance(ArmatureMotion(0.0, 0.0, 0.0), drive, instant * (1.0 - 1e-9)).speed == 0.0
    later = advance(ArmatureMotion(0.0, 0.0, 0.0), drive, instant + 1e-6)
    # just after, K di/dt t^2 / (2 J)
    rate = (13.5 - brush.resistance_ohm * i_break) / brush.inductance_henry
    expected = brush.constant_v_s * rate * 1e-12 / (2.0 * motor.inertia_kg_m2)
    assert later.speed == pytest.approx(expected, rel=1e-3)


def test_dry_friction_alone_stops_a_motor_at_the_point_that_its_energy_allows() -> None:
    # hardly any coupling, no damping: J w^2 / 2 = dry torque * angle
    drive = ArmatureDrive(0.0, 1.0, 1e-3, 3e-3, 2e-5, 0.0, 0.5)
    motion = advance(ArmatureMotion(0.0, 20.0, 0.0), drive, 1e-3)
    assert motion.speed == 0.0
    assert motion.turned == pytest.approx(2e-5 * 400.0 / (2.0 * 0.5), rel=1e-3)
    later = advance(motion, drive, 1e-3)
    assert (later.speed, later.turned) == (0.0, motion.turned)


@pytest.mark.parametrize("share", [0.05, 0.2, 1.0])
@pytest.mark.parametrize("name", NAMES)
def test_a_short_circuited_motor_stops_when_the_matrix_exponential_says(name: str, share: float) -> None:
    motor = motor_of(name)
    brush, dry = motor.fast, share * motor.fast.constant_v_s * 13.5 / motor.fast.resistance_ohm
    drive = drive_of(brush, motor, 0.0, dry)
    rate = 1.0 / motor.inertia_kg_m2
    matrix = np.array([
        [-brush.resistance_ohm / brush.inductance_henry, -brush.constant_v_s / brush.inductance_henry, 0.0],
        [brush.constant_v_s * rate, -motor.damping_n_m_s * rate, -dry * rate],
        [0.0, 0.0, 0.0],
    ])  # fmt: skip

    def speed(time_s: float) -> float:
        return float((expm(matrix * time_s) @ (0.0, 10.0, 1.0))[1])

    stopped = next(time_s for time_s in 1e-8 * 1.5 ** np.arange(60) if speed(time_s) < 0.0)
    expected = brentq(speed, stopped / 1.5, stopped, xtol=1e-15)
    motion, within = ArmatureMotion(0.0, 10.0, 0.0), max(1e-3, stopped)
    # a quick motor keeps its speed long before the end of a step: where it does, nothing is divided by its acceleration
    for search in (instant_of_zero, getattr(instant_of_zero, "py_func", instant_of_zero)):
        assert search(motion, drive, 1.0, within) == pytest.approx(expected, rel=1e-9)


def test_a_motor_at_rest_without_dry_friction_starts() -> None:
    motor = motor_of("table_5_9")
    assert advance(ArmatureMotion(1.0, 0.0, 0.0), drive_of(motor.slow, motor, 0.0, 0.0), 1e-3).speed > 0.0


def test_the_motor_is_the_same_in_both_directions() -> None:
    motor = motor_of("table_5_9")
    for current, speed in ((0.0, 0.0), (3.0, 1.0), (-10.0, 0.5), (10.0, -0.5), (5.0, -200.0)):
        there = advance(ArmatureMotion(current, speed, 0.0), drive_of(motor.slow, motor, 13.5, 0.05), 1e-3)
        back = advance(ArmatureMotion(-current, -speed, 0.0), drive_of(motor.slow, motor, -13.5, 0.05), 1e-3)
        assert (back.current, back.speed, back.turned) == (-there.current, -there.speed, -there.turned)
