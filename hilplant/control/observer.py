"""Speed and load torque of the motor from its voltage and current: a Kalman filter with constant gains.

The model is the armature (3.30), (3.31) with the load torque as a third state that changes by noise alone. So the
estimate needs no model of the load. The resistance, which rises by 0.39 % a kelvin with copper's temperature, cannot be
told from the speed by voltage and current; the park switch can tell it: from one closing of its contact to the next the
crank turns once, and what the estimate has turned too much or too little is the resistance's error.
"""

import math

from hilplant.control.records import BelievedArmature, Cascade, Measured, Model, SpeedEstimate
from hilplant.jit import compiled
from hilplant.units import TURN_RAD

#: The resistance's factor stays within these.
LEAST_FACTOR, GREATEST_FACTOR = 0.5, 2.0
#: A turn with less charge than this [A s] says nothing about the resistance.
LEAST_CHARGE_A_S = 0.05


@compiled
def correct(estimate: SpeedEstimate, measured: Measured, model: Model) -> SpeedEstimate:
    """Return what is believed at this instant, after a look at the measurements.

    A current that is not a finite number is taken as the one that was expected, a speed likewise: the
    observer then runs on the model alone. The motor does not turn backwards.
    """
    o = model.observer
    current = finite_or_zero(measured.current_a - estimate.current_a)
    speed = 0.0
    if o.speed_2 != 0.0:
        speed = finite_or_zero(measured.speed_rad_s * model.armature.gear_ratio - estimate.motor_speed_rad_s)
    return SpeedEstimate(
        estimate.current_a + o.current_1 * current + o.speed_1 * speed,
        max(0.0, estimate.motor_speed_rad_s + o.current_2 * current + o.speed_2 * speed),
        estimate.torque_n_m + o.current_3 * current + o.speed_3 * speed,
        estimate.resistance_factor,
        estimate.turned_rad,
        estimate.charge_a_s,
        estimate.contact,
    )


@compiled
def predict(now: SpeedEstimate, voltage_v: float, model: Model, period_s: float) -> SpeedEstimate:
    """Return what is believed for the next tick, with the voltage [V] that is in force until then."""
    o, a = model.observer, model.armature
    i, w, torque = now.current_a, now.motor_speed_rad_s, now.torque_n_m
    drive = voltage_v - a.resistance_ohm * (now.resistance_factor - 1.0) * i
    ahead_i = o.a11 * i + o.a12 * w + o.a13 * torque + o.b1 * drive
    ahead_w = max(0.0, o.a21 * i + o.a22 * w + o.a23 * torque + o.b2 * drive)
    turned, charge = now.turned_rad, now.charge_a_s
    if turned >= 0.0:
        turned += 0.5 * (w + ahead_w) * period_s / a.gear_ratio
        charge += 0.5 * (i + ahead_i) * period_s
    return SpeedEstimate(ahead_i, ahead_w, torque, now.resistance_factor, turned, charge, now.contact)


@compiled
def learn_resistance(
    now: SpeedEstimate, park_contact: float, armature: BelievedArmature, adapting: float
) -> SpeedEstimate:
    """Return the belief; where the park contact has just closed after a whole turn, with a corrected resistance.

    With w = (V - R i)/K, a resistance too small by dR makes the turn too long by dR/(K N) times the charge that has
    flown. `adapting` is the part of it, 0 to 1, that is taken over at once.
    """
    if not (park_contact > 0.5 and now.contact < 0.5):
        return SpeedEstimate(
            now.current_a,
            now.motor_speed_rad_s,
            now.torque_n_m,
            now.resistance_factor,
            now.turned_rad,
            now.charge_a_s,
            park_contact,
        )
    factor = now.resistance_factor
    if now.turned_rad >= 0.0 and now.charge_a_s > LEAST_CHARGE_A_S:
        excess = (now.turned_rad - TURN_RAD) * armature.constant_v_s * armature.gear_ratio / now.charge_a_s
        factor = min(max(factor + adapting * excess / armature.resistance_ohm, LEAST_FACTOR), GREATEST_FACTOR)
    return SpeedEstimate(now.current_a, now.motor_speed_rad_s, now.torque_n_m, factor, 0.0, 0.0, park_contact)


@compiled
def voltage_for(estimate: SpeedEstimate, speed_rad_s: float, armature: BelievedArmature, cascade: Cascade) -> float:
    """Return the voltage [V] that brings the crank to a speed [rad/s] and holds it there against the believed load.

    Two loops in a row, each a first order lag by the model: the speed asks for a torque, the torque for a current,
    the current for a voltage. Load torque and back-EMF are known from the observer and need no feedback.
    """
    a = armature
    w, wanted_w = estimate.motor_speed_rad_s, speed_rad_s * a.gear_ratio
    torque = estimate.torque_n_m + a.damping_n_m_s * w + a.inertia_kg_m2 * cascade.speed_rate * (wanted_w - w)
    wanted_i = torque / a.constant_v_s
    resistance = a.resistance_ohm * estimate.resistance_factor
    rise = a.inductance_henry * cascade.current_rate * (wanted_i - estimate.current_a)
    return a.constant_v_s * w + resistance * estimate.current_a + rise


@compiled
def finite_or_zero(value: float) -> float:
    """Return the value, or 0 when it is not finite."""
    return value if math.isfinite(value) else 0.0
