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

from hilplant.jit import compiled
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
    return mean * mean + rise * rise / 12.0 + bend * bend / 180.0


@compiled
def warmed(now: HeatState, lost: Losses, heat: Heat, step_s: float) -> HeatState:
    """Return temperatures and thermal switch a tick later.

    With A the matrix of the two equations, its eigenvalues m +- s, both real and below 0:
    exp(A t) = exp(m t) (cosh(s t) 1 + sinh(s t)/s (A - m 1)).
    """
    a, b = heat.winding_to_case_w_k / heat.winding_j_k, heat.winding_to_case_w_k / heat.case_j_k
    c = heat.case_to_ambient_w_k / heat.case_j_k
    case_end = lost.ambient_c + (lost.copper_w + lost.friction_w) / heat.case_to_ambient_w_k
    winding_end = case_end + lost.copper_w / heat.winding_to_case_w_k
    mean, half = -0.5 * (a + b + c), 0.5 * (b + c - a)
    s = math.sqrt(half * half + a * b)
    slow, fast = math.exp((mean + s) * step_s), math.exp((mean - s) * step_s)
    even, odd = 0.5 * (slow + fast), 0.5 * (slow - fast) / s
    x, y = now.winding_c - winding_end, now.case_c - case_end
    winding = winding_end + (even + odd * half) * x + odd * a * y
    case = case_end + odd * b * x + (even - odd * half) * y
    opened = now.opened
    if heat.has_switch < 0.5 or winding <= heat.reset_c:
        opened = 0.0
    elif winding >= heat.trip_c:
        opened = 1.0
    return HeatState(winding, case, opened)
