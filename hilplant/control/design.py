"""Observers for a motor: exact discretisation and constant Kalman gains, at construction time."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm, solve_discrete_are

from hilplant.control.records import BelievedArmature, Model, Observer, Pid
from hilplant.models.records import Motor


class ObserverNoise(NamedTuple):
    """Standard deviations that the Kalman gain weighs, all at the sampling instants; all assumed.

    `current_a`, `speed_rad_s` (of the motor): of the measurements. `voltage_v`: of what the
    model does not know of the voltage. `torque_rate`: of the load torque's change [N m/s in the root mean square].
    """

    current_a: float = 0.05
    speed_rad_s: float = 0.3
    voltage_v: float = 0.02
    torque_rate: float = 10.0


def armature(motor: Motor, fast: bool, load_inertia_kg_m2: float = 0.0) -> BelievedArmature:
    """Return one brush of a motor, with an inertia of the load [kg m2, at the motor shaft] taken for granted."""
    brush = motor.fast if fast else motor.slow
    inertia = motor.inertia_kg_m2 + load_inertia_kg_m2
    return BelievedArmature(*brush, inertia, motor.damping_n_m_s, motor.gear_ratio)


@lru_cache(maxsize=64)  # a Riccati equation each; many controllers believe in the same motor
def model(believed: BelievedArmature, period_s: float, noise: ObserverNoise, speed_sensor: bool) -> Model:
    """Return a brush with its observer: x = (i, w, torque), torque held, gains from the discrete Riccati equation.

    ``expm`` of the augmented matrix gives the exact discretisation; the gains are those of the filter form, in which
    the measurement of a tick corrects the belief of the same tick.
    """
    a = believed
    continuous = np.zeros((4, 4))
    continuous[0] = [-a.resistance_ohm / a.inductance_henry, -a.constant_v_s / a.inductance_henry, 0.0, 0.0]
    continuous[0, 3] = 1.0 / a.inductance_henry
    continuous[1, :3] = np.array([a.constant_v_s, -a.damping_n_m_s, -1.0]) / a.inertia_kg_m2
    discrete = expm(continuous * period_s)
    transition, from_voltage = discrete[:3, :3], discrete[:3, 3]
    measures = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])[: 2 if speed_sensor else 1]
    seen = np.diag([noise.current_a**2, noise.speed_rad_s**2][: len(measures)])
    unknown = np.outer(from_voltage, from_voltage) * noise.voltage_v**2
    unknown += np.diag([1e-12, 1e-12, (noise.torque_rate * period_s) ** 2])
    covariance = solve_discrete_are(transition.T, measures.T, unknown, seen)
    gain = covariance @ measures.T @ np.linalg.inv(measures @ covariance @ measures.T + seen)
    by_speed = gain[:, 1] if speed_sensor else np.zeros(3)
    return Model(a, Observer(*transition[:2].ravel(), *from_voltage[:2], *gain[:, 0], *by_speed))


def internal_model_pid(believed: BelievedArmature, period_s: float, load_inertia_kg_m2: float = 2.5e-5) -> Pid:
    """Return PI gains by Skogestad's internal model control rules (SIMC; J. Process Control 13, 2003, 291-309).

    The motor from voltage to crank speed is two lags. The longer one is kept, half of the shorter one is counted as
    its own and half as dead time (the half rule), to which a period of sampling and holding is added. The
    closed loop is asked to be as quick as that dead time, SIMC's choice. `load_inertia_kg_m2`, at the motor shaft, is
    about the mean of what linkage, arms and blades add.
    """
    a = believed
    inertia = a.inertia_kg_m2 + load_inertia_kg_m2
    strength = a.resistance_ohm * a.damping_n_m_s + a.constant_v_s**2
    second = a.inductance_henry * inertia
    first = a.resistance_ohm * inertia + a.inductance_henry * a.damping_n_m_s
    rates = -np.roots([second, first, strength])
    long, short = sorted((1.0 / rates.real), reverse=True)
    gain = a.constant_v_s / (strength * a.gear_ratio)
    dead = 0.5 * short + period_s
    long += 0.5 * short
    proportional = long / (gain * 2.0 * dead)
    return Pid(float(proportional), float(proportional / min(long, 8.0 * dead)))
