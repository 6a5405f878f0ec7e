"""Closed-form motion of armature current and motor speed at constant voltage and constant torque.

(3.30) and (3.31) of Dooner (2016) are x' = A x + B u with x = (i, w) and

    A = [[-R/L, -K/L], [K/J, -d/J]],    u = (V, T).

With the eigenvalues p1 >= p2 of A, exp(A t) = exp(p1 t) 1 + f (A - p1 1), f = (exp(p1 t) - exp(p2 t)) / (p1 - p2);
with a complex pair m +- j s, exp(A t) = exp(m t) (cos(s t) 1 + sin(s t)/s (A - m 1)). Both are written so that
nothing overflows, and nothing is lost where the eigenvalues come together: no exponent is positive, p1 comes from
det A / p2, the difference in f from expm1.
"""

import math
from typing import NamedTuple

from hilplant.jit import compiled


class ArmatureMotion(NamedTuple):
    """Armature current [A], motor speed [rad/s], and the angle [rad] by which the shaft has turned."""

    current: float
    speed: float
    turned: float


class ArmatureDrive(NamedTuple):
    """What acts on the armature for a while, all SI, all seen at the motor shaft; an open armature has constant 0."""

    voltage: float
    resistance: float
    inductance: float
    constant: float
    inertia: float
    damping: float  # of the motor and of its load
    dry_torque: float  # opposes motion whatever the speed: dry friction, and the constant part of the load
    push: float = 0.0  # drives in the wiping direction whatever the speed: current through a second brush


@compiled
def propagator(drive: ArmatureDrive, time: float) -> tuple[float, float, float, float]:
    """Return exp(A t) as its elements (11, 12, 21, 22), for t >= 0."""
    a11, a12 = -drive.resistance / drive.inductance, -drive.constant / drive.inductance
    a21, a22 = drive.constant / drive.inertia, -drive.damping / drive.inertia
    mean, half = 0.5 * (a11 + a22), 0.5 * (a11 - a22)
    discriminant = half * half + a12 * a21
    s = math.sqrt(abs(discriminant))
    if discriminant > 0.0:
        shift = (a11 * a22 - a12 * a21) / (mean - s)
        one = math.exp(shift * time)
        f = one * (-math.expm1(-2.0 * s * time) / (2.0 * s))
    else:
        shift = mean
        decay = math.exp(mean * time)
        one = decay * math.cos(s * time)
        f = decay * (math.sin(s * time) / s if s > 0.0 else time)
    return one + f * (a11 - shift), f * a12, f * a21, one + f * (a22 - shift)


@compiled
def glide(motion: ArmatureMotion, drive: ArmatureDrive, torque: float, time: float) -> ArmatureMotion:
    """Return the motion after `time` while a constant `torque` [N m], less the push, works against positive speed.

    Exact, the turned angle too: it follows from the time integrals of (3.30), not from a rule of quadrature.
    """
    torque -= drive.push
    if drive.constant == 0.0:
        return coast(motion, drive, torque, time)
    strength = drive.resistance * drive.damping + drive.constant * drive.constant
    final_current = (drive.voltage * drive.damping + drive.constant * torque) / strength
    final_speed = (drive.voltage * drive.constant - drive.resistance * torque) / strength
    e11, e12, e21, e22 = propagator(drive, time)
    i, w = motion.current - final_current, motion.speed - final_speed
    current = final_current + e11 * i + e12 * w
    speed = final_speed + e21 * i + e22 * w
    flux = drive.constant * drive.inductance * (current - motion.current)
    momentum = drive.resistance * drive.inertia * (speed - motion.speed)
    return ArmatureMotion(current, speed, motion.turned + final_speed * time - (flux + momentum) / strength)


@compiled
def coast(motion: ArmatureMotion, drive: ArmatureDrive, torque: float, time: float) -> ArmatureMotion:
    """Return the motion after `time` with the armature open: no current, J dw/dt = -d w - torque.

    With x = d t / J, w falls by (d w + T)/d (1 - exp(-x)); small x, down to no damping at all, take the series.
    """
    x = drive.damping * time / drive.inertia
    if x < 1e-3:
        first = 1.0 - x * (0.5 - x * (1.0 / 6.0 - x / 24.0))
        second = 0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0))
    else:
        first = -math.expm1(-x) / x
        second = (1.0 - first) / x
    change = -(drive.damping * motion.speed + torque) / drive.inertia * time
    return ArmatureMotion(0.0, motion.speed + change * first, motion.turned + time * (motion.speed + change * second))


@compiled
def acceleration(motion: ArmatureMotion, drive: ArmatureDrive, torque: float) -> float:
    """Return the acceleration of the motor shaft [rad/s2]."""
    return (drive.constant * motion.current + drive.push - drive.damping * motion.speed - torque) / drive.inertia
