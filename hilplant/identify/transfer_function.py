"""The motor as a transfer function from voltage to current, and back to parameters: (5.7) to (5.10), (5.15), Table 5-1.

Assumes a load torque in proportion to the speed, gamma w, and a back-EMF constant equal to the torque constant.
"""

import math
from typing import NamedTuple


class TransferFunction(NamedTuple):
    """I(s)/V(s) = (b1 s + b0)/(s^2 + a1 s + a0), with V in volts and I in amperes."""

    b1: float
    b0: float
    a1: float
    a0: float


class Coefficients(NamedTuple):
    """The coefficients of (5.8) as Table 5-1 defines them."""

    gain_a_v_s: float  # K_sys = 1/L [A/(V s)]
    electrical_s: float  # t_elec = L/R
    mechanical_s: float  # t_mech = R J/K^2
    load_1_s: float  # t_r = (b + gamma)/J


class Equivalent(NamedTuple):
    """Motor parameters that have the same transfer function."""

    resistance_ohm: float
    inductance_henry: float
    constant_v_s: float
    inertia_kg_m2: float
    drag_n_m_s: float  # b + gamma


def load_constant(torque_n_m: float = 3.0, crank_speed_rad_s: float = 2.0 * math.pi, gear_ratio: float = 63.0) -> float:
    """Return gamma [N m s/rad] at the shaft for a load torque at the crank at one speed, (5.15)."""
    return torque_n_m / gear_ratio / (gear_ratio * crank_speed_rad_s)


def coefficients(function: TransferFunction) -> Coefficients:
    """Return the coefficients of (5.8) for a transfer function; the inverse of :func:`transfer_function`."""
    load_1_s = function.b0 / function.b1
    electrical_s = 1.0 / (function.a1 - load_1_s)
    mechanical_s = 1.0 / (function.a0 * electrical_s - load_1_s)
    return Coefficients(function.b1, electrical_s, mechanical_s, load_1_s)


def transfer_function(found: Coefficients) -> TransferFunction:
    """Return the transfer function (5.8) of the coefficients."""
    gain, electrical_s, mechanical_s, load_1_s = found
    a1 = load_1_s + 1.0 / electrical_s
    return TransferFunction(gain, gain * load_1_s, a1, (load_1_s + 1.0 / mechanical_s) / electrical_s)


def of_motor(motor: Equivalent) -> TransferFunction:
    """Return the transfer function (5.7) of a motor with its load."""
    r, inductance, k, j, drag = motor
    a0 = (drag * r + k * k) / (inductance * j)
    return TransferFunction(1.0 / inductance, drag / (inductance * j), drag / j + r / inductance, a0)


def by_load(found: Coefficients, drag_n_m_s: float) -> Equivalent:
    """Return the motor for an assumed b + gamma [N m s/rad]: the thesis' way, with b = 0.

    Resistance and inductance come from the data alone; constant and inertia scale with the assumption.
    """
    inductance_henry = 1.0 / found.gain_a_v_s
    resistance_ohm = inductance_henry / found.electrical_s
    inertia_kg_m2 = drag_n_m_s / found.load_1_s
    constant = (resistance_ohm * inertia_kg_m2 / found.mechanical_s) ** 0.5
    return Equivalent(resistance_ohm, inductance_henry, constant, inertia_kg_m2, drag_n_m_s)


def by_constant(found: Coefficients, constant_v_s: float) -> Equivalent:
    """Return the motor for a known back-EMF constant, such as one measured with the park switch (5.18).

    Nothing is assumed of the load's size, so inertia and drag come from the data too.
    """
    inductance_henry = 1.0 / found.gain_a_v_s
    resistance_ohm = inductance_henry / found.electrical_s
    inertia_kg_m2 = found.mechanical_s * constant_v_s * constant_v_s / resistance_ohm
    return Equivalent(resistance_ohm, inductance_henry, constant_v_s, inertia_kg_m2, found.load_1_s * inertia_kg_m2)
