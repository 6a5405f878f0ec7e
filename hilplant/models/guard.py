"""No number that is not finite travels through the plant: the motor stops, and a flag says so until a restart."""

import math

from hilplant.jit import compiled
from hilplant.models.records import Inputs, State


@compiled
def admit(state: State, inputs: Inputs) -> tuple[State, Inputs]:
    """Return state and inputs as they are when all are finite and the guard is not set.

    Else the guard is set, the motor stands still without current where it was, its relays are off, and inputs that
    are not finite are 0.
    """
    # 0 times a finite number is 0, times anything else not-a-number: one comparison looks at all
    zero = 0.0 * state.current_a + 0.0 * state.motor_speed_rad_s + 0.0 * state.crank_angle_rad
    zero += 0.0 * inputs.relay_on + 0.0 * inputs.relay_fast + 0.0 * inputs.supply_v + 0.0 * inputs.screen
    zero += 0.0 * inputs.vehicle_speed_m_s + 0.0 * inputs.brake_torque_n_m
    if zero == 0.0 and state.guard == 0.0:
        return state, inputs
    held = State(
        0.0, 0.0, finite(state.crank_angle_rad), finite(state.park_contact), finite(state.bounce_left), 1.0
    )
    safe = Inputs(0.0, 0.0, finite(inputs.supply_v), finite(inputs.screen), finite(inputs.vehicle_speed_m_s), 0.0)
    return held, safe


@compiled
def hold_if_wrong(state: State, last_angle: float) -> State:
    """Return `state`, or if its motion is not finite a motor at rest at the last angle, with the guard set."""
    zero = 0.0 * state.current_a + 0.0 * state.motor_speed_rad_s + 0.0 * state.crank_angle_rad
    if zero == 0.0:
        return state
    return State(0.0, 0.0, last_angle, state.park_contact, state.bounce_left, 1.0)


@compiled
def finite(value: float) -> float:
    """Return the value, or 0 when it is not finite."""
    return value if math.isfinite(value) else 0.0
