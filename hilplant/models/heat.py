"""Heat in the motor: two bodies that copper and friction warm, what they do to the motor, and its thermal switch.

    Cw dTw/dt = P - G (Tw - Tc)                  P: copper loss i^2 R of the winding [W]
    Cc dTc/dt = F + G (Tw - Tc) - A (Tc - Ta)    F: loss by friction of the motor shaft [W]

with the winding at Tw, the case with the magnets at Tc, the air at Ta. This is the usual network of two bodies of motor
data sheets (their thermal resistances are 1/G and 1/A). Losses of the gear are left out: they warm its housing
(assumed). Resistances follow the winding, motor constants the magnets:

    R = R(ref) (1 + a (Tw - Tref)),    K = K(ref) (1 + b (Tc - Tref)).

Within a tick the losses are constant and the temperatures exact; R and K are those at the tick's start.
"""

import math
from typing import NamedTuple

from hilplant.jit import compiled, compiled_apart
from hilplant.models.armature import ArmatureMotion
from hilplant.models.circuit import Connection
from hilplant.models.records import Brush, Motor, Parameters
from hilplant.models.row import changed
from hilplant.models.slow_records import Heat, HeatState


class Brushes(NamedTuple):
    """Both armature paths."""

    slow: Brush
    fast: Brush


class Losses(NamedTuple):
    """Mean heat during a tick [W], and the temperature of the air [degC]."""

    copper_w: float
    friction_w: float
    ambient_c: float


class Rates(NamedTuple):
    """Of both bodies, times a tick: of the winding, of the case by the winding, and of the case."""

    winding: float
    into_case: float
    of_case: float


class Rise(NamedTuple):
    """By how much both bodies warm [K]."""

    winding_k: float
    case_k: float


#: Rates of both bodies, times a tick, up to which the series tells all bits.
SHORT = 1e-3


@compiled
def heated(motor: Motor, heat: Heat, now: HeatState) -> Motor:
    """Return the motor at the temperatures that it has."""
    resistance = 1.0 + heat.resistance_per_k * (now.winding_c - heat.reference_c)
    constant = 1.0 + heat.constant_per_k * (now.case_c - heat.reference_c)
    slow, fast = motor.slow, motor.fast
    return changed(
        motor,
        Brushes(
            Brush(slow.resistance_ohm * resistance, slow.inductance_henry, slow.constant_v_s * constant),
            Brush(fast.resistance_ohm * resistance, fast.inductance_henry, fast.constant_v_s * constant),
        ),
    )


@compiled
def losses(
    before: ArmatureMotion, after: ArmatureMotion, connection: Connection, parameters: Parameters, ambient_c: float
) -> Losses:
    """Return the mean losses between two instants a tick apart.

    The mean current follows from the time integral of (3.30), exactly. For current and speed as parabolas through both
    ends with the right mean the squares are exact too.
    """
    motor, brush, step_s = parameters.motor, connection.brush, parameters.step_s
    chosen, other = motor.slow, motor.fast
    if connection.fast > 0.5:
        chosen, other = motor.fast, motor.slow
    speed = (after.turned - before.turned) / step_s
    copper = connection.second.current_a * connection.second.current_a * other.resistance_ohm
    if connection.closed > 0.5:
        flux = brush.inductance_henry * (after.current - before.current)
        mean = (connection.source_v - brush.constant_v_s * speed - flux / step_s) / brush.resistance_ohm
        copper += chosen.resistance_ohm * mean_square(before.current, mean, after.current)
    friction = motor.damping_n_m_s * mean_square(before.speed, speed, after.speed)
    return Losses(copper, friction + motor.coulomb_torque_n_m * abs(speed), ambient_c)


@compiled
def mean_square(start: float, mean: float, end: float) -> float:
    """Return the mean of the square of a parabola with these two ends and this mean."""
    rise, bend = end - start, 6.0 * (0.5 * (start + end) - mean)
    return mean * mean + (15.0 * rise * rise + bend * bend) / 180.0


@compiled
def warmed(now: HeatState, lost: Losses, heat: Heat, step_s: float) -> HeatState:
    """Return temperatures and thermal switch a tick later."""
    winding_k_j, case_k_j = step_s / heat.winding_j_k, step_s / heat.case_j_k
    out = heat.winding_to_case_w_k * (now.winding_c - now.case_c)
    leaving = heat.case_to_ambient_w_k * (now.case_c - lost.ambient_c)
    winding_k, case_k = (lost.copper_w - out) * winding_k_j, (lost.friction_w + out - leaving) * case_k_j
    a, b = heat.winding_to_case_w_k * winding_k_j, heat.winding_to_case_w_k * case_k_j
    rates = Rates(a, b, b + heat.case_to_ambient_w_k * case_k_j)
    rise = risen(Rise(winding_k, case_k), rates)
    winding_c, opened = now.winding_c + rise.winding_k, now.opened
    if heat.has_switch < 0.5 or winding_c <= heat.reset_c:
        opened = 0.0
    elif winding_c >= heat.trip_c:
        opened = 1.0
    return HeatState(winding_c, now.case_c + rise.case_k, opened)


@compiled
def risen(at_start: Rise, rates: Rates) -> Rise:
    """Return by how much both bodies warm in a tick, from what it would be at the rates of its start.

    With A the matrix of the two equations times the tick this is A^-1 (exp(A) - 1) = 1 + A/2 + A^2/6 + A^3/24 + ...;
    the next term is less than a bit of it where the tick is as short beside the bodies as `SHORT` says.
    """
    if rates.winding + rates.of_case > SHORT:
        return risen_in_long(at_start, rates)
    rise = fed_back(at_start, at_start, rates, 0.25)
    rise = fed_back(at_start, rise, rates, 1.0 / 3.0)
    return fed_back(at_start, rise, rates, 0.5)


@compiled
def fed_back(at_start: Rise, rise: Rise, rates: Rates, part: float) -> Rise:
    """Return `at_start` and that part of what the matrix makes of `rise`."""
    winding_k = rates.winding * (rise.case_k - rise.winding_k)
    case_k = rates.into_case * rise.winding_k - rates.of_case * rise.case_k
    return Rise(at_start.winding_k + part * winding_k, at_start.case_k + part * case_k)


@compiled_apart
def risen_in_long(at_start: Rise, rates: Rates) -> Rise:
    """Return the same by the eigenvalues m +- s of A, both real and below 0.

    exp(A) = exp(m) (cosh(s) 1 + sinh(s)/s (A - m 1)).
    """
    a, b, c = rates.winding, rates.into_case, rates.of_case
    scale = 1.0 / (a * (c - b))
    x = -scale * (c * at_start.winding_k + a * at_start.case_k)
    y = -scale * (b * at_start.winding_k + a * at_start.case_k)
    mean, half = -0.5 * (a + c), 0.5 * (c - a)
    s = math.sqrt(half * half + a * b)
    slow, fast = math.exp(mean + s), math.exp(mean - s)
    even, odd = 0.5 * (slow + fast), 0.5 * (slow - fast) / s
    return Rise((even + odd * half - 1.0) * x + odd * a * y, odd * b * x + (even - odd * half - 1.0) * y)
