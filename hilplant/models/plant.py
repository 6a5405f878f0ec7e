"""The whole step of the plant. Server, offline simulation, identification and replay all call this one."""

from typing import Any, NamedTuple

from hilplant.jit import compiled
from hilplant.models.armature import ArmatureMotion
from hilplant.models.backlash import join, linkage_crank
from hilplant.models.circuit import connect, next_phase
from hilplant.models.guard import admit, admitted, hold_if_wrong
from hilplant.models.linkage_faults import LINK_BROKEN, broken_at
from hilplant.models.load import network_now, resist_as
from hilplant.models.lookup import derivative, value, within_turn
from hilplant.models.mechanical_records import LinkageCondition, Obstacles
from hilplant.models.motor_choice import move
from hilplant.models.park_switch import contact_now
from hilplant.models.records import Parameters, Relays, Sensors, State, Wiring
from hilplant.models.reduced import left_pressing, right_pressing
from hilplant.models.relays import move_relays
from hilplant.models.resistance import Crank
from hilplant.models.row import changed, unpack, write
from hilplant.models.sensors import read_current, stick_contact
from hilplant.models.shaft import Joint, Train, load_torque, start_of
from hilplant.models.slow_records import Heat, Water, Wear
from hilplant.models.slow_states import Reached, as_it_is, nothing_slow, slow_after
from hilplant.models.tables import LEFT_ROCKER, RIGHT_ROCKER
from hilplant.models.water import rain_signal, wetted
from hilplant.signals import Inputs, Outputs


@compiled
def step(state: State, inputs: Inputs, parameters: Parameters, tables: Any) -> tuple[State, Outputs]:
    """Return the state at the next tick, and the outputs at this one.

    The outputs belong to the instant of `state` with `inputs` already in force: the terminal voltage follows the
    relays at once, the current is still the old one.

    Parameters
    ----------
    state, inputs, parameters
        See :mod:`hilplant.models.records`; the state is finite, see :func:`hilplant.models.guard.admitted`.
    tables
        Array [knots + 1, channels, 2] over the crank angle; see :mod:`hilplant.models.tables`.

    """
    state, inputs = admit(state, inputs)  # 1 what is not finite stays outside; the plant is as slow states made it
    actual, angle = as_it_is(parameters, state), state.crank_angle_rad
    inputs, speed = wetted(inputs, actual, state.water), state.motor_speed_rad_s / actual.motor.gear_ratio
    # 2 park switch, relays, supply, wires and park circuit
    contact = contact_now(angle, state.park_contact, state.bounce_left, actual.park_switch)
    contact, moved = stick_contact(contact, actual.sensors), move_relays(inputs, state, actual)
    phase = next_phase(moved.inputs, actual.park_switch, contact, state.park_phase, angle)
    connection = connect(moved.inputs, actual, contact, phase, state)
    # 3 kinematics and load at this instant
    motion = ArmatureMotion(state.current_a if connection.closed > 0.5 else 0.0, state.motor_speed_rad_s, 0.0)
    load_mode, tangent = network_now(actual, inputs, speed, state)
    train = Train(connection, tables, inputs, actual, load_mode, tangent)
    crank = linkage_crank(speed, state, actual, tables)
    load = resist_as(load_mode, tangent, crank, actual, inputs)
    start = start_of(motion, load, train)
    torque_n_m = load_torque(motion, load, start, train)
    # 4 motor and load together to the next tick
    joint, play = join(Joint(motion, start, crank.angle_rad, actual.step_s), crank, load, train, state.play)
    after, memory = move(joint, load, train, state)
    seen = read_current(motion.current, angle * actual.motor.gear_ratio, state.noise, actual.sensors)
    # 5 slow states; guard
    reached = within_turn(angle + after.turned / actual.motor.gear_ratio)
    slow = slow_after(crank, Reached(motion, after, reached + play.ahead_rad), train, state, parameters)
    following = State(
        current_a=without_denormals(after.current),
        motor_speed_rad_s=without_denormals(after.speed),
        crank_angle_rad=reached,
        park_contact=contact.closed,
        bounce_left=contact.bounce_left,
        guard=state.guard,
        park_phase=phase,
        memory=memory,
        load_mode=load_mode,
        relay_on=moved.on,
        relay_fast=moved.fast,
        noise=seen.noise,
        heat=slow.heat,
        ice=slow.ice,
        linkage=slow.linkage,
        play=play,
        wear=slow.wear,
        water=slow.water,
    )
    outputs = measured(motion, crank, Seen(seen.current_a, contact.shown, memory.mode, torque_n_m, state), train)
    return hold_if_wrong(following, angle, not nothing_slow(parameters)), outputs


class Seen(NamedTuple):
    """What is shown besides motion and load."""

    current_a: float
    park_contact: float
    motor_mode: float
    load_torque_n_m: float
    state: State


@compiled
def measured(motion: ArmatureMotion, crank: Crank, seen: Seen, train: Train) -> Outputs:
    """Return what can be seen of the plant at this instant."""
    inputs, parameters, connection = train.inputs, train.parameters, train.connection
    tables, place = crank.tables, crank.place
    left_rocker, right_rocker = value(tables, place, LEFT_ROCKER), value(tables, place, RIGHT_ROCKER)
    left_m_s = parameters.left_arm.length_m * derivative(tables, place, LEFT_ROCKER) * crank.speed_rad_s
    right_m_s = parameters.right_arm.length_m * derivative(tables, place, RIGHT_ROCKER) * crank.speed_rad_s
    if parameters.linkage.altered > 0.5:
        stands = broken_at(crank, parameters.linkage, seen.state.linkage)
        if parameters.linkage.left == LINK_BROKEN:
            left_rocker, left_m_s = stands.left_rad, 0.0
        if parameters.linkage.right == LINK_BROKEN:
            right_rocker, right_m_s = stands.right_rad, 0.0
    return Outputs(
        supply_v=connection.supply_v,
        supply_current_a=connection.supply_current_a,
        terminal_v=connection.terminal_v,
        current_a=motion.current,
        motor_speed_rad_s=motion.speed,
        crank_speed_rad_s=motion.speed / parameters.motor.gear_ratio,
        crank_angle_rad=seen.state.crank_angle_rad,
        load_torque_n_m=seen.load_torque_n_m,
        park_contact=seen.park_contact,
        left_arm_rad=left_rocker + parameters.left_arm.offset_rad,
        right_arm_rad=right_rocker + parameters.right_arm.offset_rad,
        left_rocker_rad=left_rocker,
        right_rocker_rad=right_rocker,
        left_blade_m_s=left_m_s,
        right_blade_m_s=right_m_s,
        relay_on=inputs.relay_on,
        relay_fast=inputs.relay_fast,
        guard=seen.state.guard,
        terminal_53_v=connection.terminal_53_v,
        terminal_53b_v=connection.terminal_53b_v,
        terminal_53e_v=connection.terminal_53e_v,
        terminal_31_v=connection.terminal_31_v,
        left_force_n=left_pressing(crank, parameters.load, inputs).force_n,
        right_force_n=right_pressing(crank, parameters.load, inputs).force_n,
        load_mode=train.load_mode,
        motor_mode=seen.motor_mode,
        measured_current_a=seen.current_a,
        winding_temperature_c=seen.state.heat.winding_c,
        thermal_switch=seen.state.heat.opened,
        wetness=inputs.screen,
        water_film_mm=seen.state.water.film_mm,
        rain_sensor=rain_signal(seen.state.water, parameters.water),
    )


@compiled
def without_denormals(value: float) -> float:
    """Return 0 for what is too small to matter: decays would end in numbers that cost a hundred times more."""
    return 0.0 if abs(value) < 1e-30 else value


class Additions(NamedTuple):
    """The parameters that a plant without additions and faults does not look at."""

    wiring: Wiring
    relays: Relays
    sensors: Sensors
    heat: Heat
    obstacles: Obstacles
    linkage: LinkageCondition
    wear: Wear
    water: Water


NO_ADDITIONS = Additions(Wiring(), Relays(), Sensors(), Heat(), Obstacles(), LinkageCondition(), Wear(), Water())


@compiled
def is_plain(parameters: Parameters) -> bool:
    """Return whether nothing is added to the plant and nothing of it is faulty."""
    electrical = parameters.wiring.altered + parameters.relays.altered
    sensors = parameters.sensors.altered + parameters.sensors.park_stuck
    return nothing_slow(parameters) and electrical + sensors == 0.0


@compiled
def plain(parameters: Parameters) -> Parameters:
    """Return the parameters of a plain plant with constants for what is not looked at: the compiler leaves it out."""
    return changed(parameters, NO_ADDITIONS)


@compiled
def tick(state_row: Any, input_row: Any, parameter_row: Any, tables: Any, output_row: Any) -> None:
    """Take one step on packed rows of floats; `state_row` moves on, `output_row` is filled. For the server."""
    parameters = unpack(Parameters, parameter_row)
    if is_plain(parameters):
        tick_with(plain(parameters), state_row, input_row, tables, output_row)
    else:
        tick_with(parameters, state_row, input_row, tables, output_row)


@compiled
def tick_with(parameters: Parameters, state_row: Any, input_row: Any, tables: Any, output_row: Any) -> None:
    """Take one step on packed rows with these parameters."""
    state, outputs = step(admitted(unpack(State, state_row)), unpack(Inputs, input_row), parameters, tables)
    write(state, state_row)
    write(outputs, output_row)


@compiled
def simulate_rows(state_row: Any, input_rows: Any, parameter_row: Any, tables: Any, output_rows: Any) -> None:
    """Take one step for each row of inputs, and leave its outputs in the same row of `output_rows`."""
    parameters = unpack(Parameters, parameter_row)
    if is_plain(parameters):
        simulate_with(plain(parameters), state_row, input_rows, tables, output_rows)
    else:
        simulate_with(parameters, state_row, input_rows, tables, output_rows)


@compiled
def simulate_with(parameters: Parameters, state_row: Any, input_rows: Any, tables: Any, output_rows: Any) -> None:
    """Take one step for each row of inputs with these parameters."""
    state = admitted(unpack(State, state_row))
    for index in range(input_rows.shape[0]):
        state, outputs = step(state, unpack(Inputs, input_rows[index]), parameters, tables)
        write(outputs, output_rows[index])
    write(state, state_row)
