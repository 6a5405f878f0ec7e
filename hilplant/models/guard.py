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
    zero = spoilt_state(state) + spoilt_inputs(inputs)
    if zero == 0.0 and state.guard == 0.0:
        return state, inputs
    held = State(
        current_a=0.0,
        motor_speed_rad_s=0.0,
        crank_angle_rad=finite(state.crank_angle_rad),
        park_contact=finite(state.park_contact),
        bounce_left=finite(state.bounce_left),
        guard=1.0,
        park_phase=finite(state.park_phase),
        last_terminal_v=0.0,
        last_torque_n_m=0.0,
        last_current_a=0.0,
        last_speed_rad_s=0.0,
        last_brush=0.0,
        motor_mode=0.0,
        load_mode=0.0,
    )
    safe = Inputs(
        relay_on=0.0,
        relay_fast=0.0,
        supply_v=finite(inputs.supply_v),
        screen=finite(inputs.screen),
        vehicle_speed_m_s=finite(inputs.vehicle_speed_m_s),
        brake_torque_n_m=0.0,
        left_screen=finite(inputs.left_screen),
        right_screen=finite(inputs.right_screen),
        left_wear=finite(inputs.left_wear),
        right_wear=finite(inputs.right_wear),
        left_force=finite(inputs.left_force),
        right_force=finite(inputs.right_force),
    )
    return held, safe


@compiled
def spoilt_state(state: State) -> float:
    """Return 0 when all that moves is finite, else not-a-number; 0 times a finite number is 0, any other is not."""
    return 0.0 * state.current_a + 0.0 * state.motor_speed_rad_s + 0.0 * state.crank_angle_rad


@compiled
def spoilt_inputs(inputs: Inputs) -> float:
    """Return 0 when all inputs are finite, else not-a-number."""
    zero = 0.0 * inputs.relay_on + 0.0 * inputs.relay_fast + 0.0 * inputs.supply_v + 0.0 * inputs.screen
    zero += 0.0 * inputs.vehicle_speed_m_s + 0.0 * inputs.brake_torque_n_m
    zero += 0.0 * inputs.left_screen + 0.0 * inputs.right_screen
    zero += 0.0 * inputs.left_wear + 0.0 * inputs.right_wear
    return zero + 0.0 * inputs.left_force + 0.0 * inputs.right_force


@compiled
def hold_if_wrong(state: State, last_angle: float) -> State:
    """Return `state`, or if its motion is not finite, or the guard set, a motor at rest at the last angle.

    A circuit that is switched off may still turn the motor; it must not when the guard is set.
    """
    if spoilt_state(state) == 0.0 and state.guard == 0.0:
        return state
    contact, bounce_left, phase = state.park_contact, state.bounce_left, state.park_phase
    return State(0.0, 0.0, last_angle, contact, bounce_left, 1.0, phase, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@compiled
def finite(value: float) -> float:
    """Return the value, or 0 when it is not finite."""
    return value if math.isfinite(value) else 0.0
