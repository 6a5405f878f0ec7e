"""The whole step of the plant. Server, offline simulation, identification and replay all call this one."""

import math
from typing import Any

from hilplant.jit import compiled
from hilplant.models.armature import Drive, Motion
from hilplant.models.circuit import switch
from hilplant.models.guard import admit, hold_if_wrong
from hilplant.models.load import load_damping, load_torque
from hilplant.models.lookup import hermite
from hilplant.models.motor import advance
from hilplant.models.park_switch import contact_now
from hilplant.models.records import (
    Brush,
    Inputs,
    Outputs,
    Parameters,
    State,
    unpack_inputs,
    unpack_parameters,
    unpack_state,
)
from hilplant.units import TURN_RAD


@compiled
def step(state: State, inputs: Inputs, parameters: Parameters, tables: Any) -> tuple[State, Outputs]:
    """Return the state at the next tick, and the outputs at this one.

    The outputs belong to the instant of `state` with `inputs` already in force: the terminal voltage follows the
    relays at once, the current is still the old one.

    Parameters
    ----------
    state, inputs, parameters
        See :mod:`hilplant.models.records`.
    tables
        Array [2, n + 1, 2]: for the left and the right rocker, at even steps of the crank angle from 0 to one turn,
        angle [rad] and derivative over the crank angle.

    """
    # 1 what is not finite stays outside
    state, inputs = admit(state, inputs)
    angle, speed = state.crank_angle_rad, state.motor_speed_rad_s / parameters.motor.gear_ratio
    # 2 supply and relays
    brush, terminal_v = switch(inputs, parameters.motor)
    # 3 park switch
    contact = contact_now(angle, state.park_contact, state.bounce_left, parameters.park_switch)
    # 4 kinematics and load at this instant
    left_rocker, left_slope = hermite(tables, 0, angle)
    right_rocker, right_slope = hermite(tables, 1, angle)
    outputs = Outputs(
        supply_v=inputs.supply_v,
        terminal_v=terminal_v,
        current_a=state.current_a,
        motor_speed_rad_s=state.motor_speed_rad_s,
        crank_speed_rad_s=speed,
        crank_angle_rad=angle,
        load_torque_n_m=load_torque(angle, speed, parameters.load, inputs.brake_torque_n_m),
        park_contact=contact.shown,
        left_arm_rad=left_rocker + parameters.left_arm.offset_rad,
        right_arm_rad=right_rocker + parameters.right_arm.offset_rad,
        left_rocker_rad=left_rocker,
        right_rocker_rad=right_rocker,
        left_blade_m_s=parameters.left_arm.length_m * left_slope * speed,
        right_blade_m_s=parameters.right_arm.length_m * right_slope * speed,
        relay_on=inputs.relay_on,
        relay_fast=inputs.relay_fast,
        guard=state.guard,
    )
    # 5 motor and load together to the next tick
    start = Motion(state.current_a, state.motor_speed_rad_s, 0.0)
    motion = advance(start, drive_during_step(state, inputs, parameters, brush, terminal_v), parameters.step_s)
    # 6 guard
    following = State(
        without_denormals(motion.current),
        without_denormals(motion.speed),
        within_turn(angle + motion.turned / parameters.motor.gear_ratio),
        contact.closed,
        contact.bounce_left,
        state.guard,
    )
    return hold_if_wrong(following, angle), outputs


@compiled
def drive_during_step(
    state: State, inputs: Inputs, parameters: Parameters, brush: Brush, terminal_v: float
) -> Drive:
    """Return what acts on the armature for one step, seen at the motor shaft, where (3.33) divides by the ratio.

    Terminal voltage and brake torque are held; the load is held as torque over speed, taken at the angle at which
    the crank will be half-way. That the load follows the speed within the step makes it stable however stiff it is.
    """
    motor, ratio = parameters.motor, parameters.motor.gear_ratio
    speed = state.motor_speed_rad_s / ratio
    half_way = state.crank_angle_rad + 0.5 * parameters.step_s * speed
    return Drive(
        voltage=terminal_v,
        resistance=brush.resistance_ohm,
        inductance=brush.inductance_henry,
        constant=brush.constant_v_s,
        inertia=motor.inertia_kg_m2,
        damping=motor.damping_n_m_s + load_damping(half_way, speed, parameters.load) / (ratio * ratio),
        dry_torque=motor.coulomb_torque_n_m + inputs.brake_torque_n_m / ratio,
    )


@compiled
def without_denormals(value: float) -> float:
    """Return 0 for what is too small to matter: decays would end in numbers that cost a hundred times more."""
    return 0.0 if abs(value) < 1e-30 else value


@compiled
def within_turn(angle: float) -> float:
    """Return the same angle in [0, 2 pi); not-a-number stays what it is."""
    if 0.0 <= angle < TURN_RAD:
        return angle
    wrapped = angle - TURN_RAD * math.floor(angle / TURN_RAD)
    return wrapped if 0.0 <= wrapped < TURN_RAD else wrapped * 0.0


@compiled
def tick(state_row: Any, input_row: Any, parameter_row: Any, tables: Any, output_row: Any) -> None:
    """Take one step on packed rows of floats; `state_row` moves on, `output_row` is filled. For the server."""
    parameters = unpack_parameters(parameter_row)
    state, outputs = step(unpack_state(state_row), unpack_inputs(input_row), parameters, tables)
    write(state, state_row)
    write(outputs, output_row)


@compiled
def simulate_rows(
    state_row: Any, input_rows: Any, parameter_row: Any, tables: Any, output_rows: Any
) -> None:
    """Take one step for each row of inputs, and leave its outputs in the same row of `output_rows`."""
    parameters = unpack_parameters(parameter_row)
    state = unpack_state(state_row)
    for index in range(input_rows.shape[0]):
        state, outputs = step(state, unpack_inputs(input_rows[index]), parameters, tables)
        write(outputs, output_rows[index])
    write(state, state_row)


@compiled
def write(record: tuple[float, ...], row: Any) -> None:
    """Write a record of floats into its row."""
    for index, value in enumerate(record):
        row[index] = value
