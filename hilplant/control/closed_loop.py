"""Plant and velocity controller in one compiled loop: the step of the server, its supply commanded by a controller."""

from typing import Any, NamedTuple

from hilplant.control.controller import Tables, control
from hilplant.control.observer import correct, learn_resistance, predict
from hilplant.control.records import AT_REST, Controller, Measured, Memory, Model, SpeedEstimate
from hilplant.jit import compiled
from hilplant.models.park_switch import contact_now
from hilplant.models.plant import step
from hilplant.models.records import Parameters, State
from hilplant.models.row import changed, unpack, write
from hilplant.models.sensors import read_current, stick_contact
from hilplant.signals import Inputs

#: Columns of a trace: estimated speed of the crank [rad/s], K in force, resistance over the model's, weights.
TRACE = ("estimated_speed_rad_s", "gain", "resistance_factor", "weight_integral", "weight_proportional")


class Commanded(NamedTuple):
    """The inputs of the plant that a controller sets."""

    relay_on: float
    relay_fast: float
    supply_v: float


@compiled
def measure(state: State, parameters: Parameters) -> Measured:
    """Return what a controller sees at this instant: the speed, and what current sensor and park contact show."""
    gear_ratio, sensors = parameters.motor.gear_ratio, parameters.sensors
    contact = contact_now(state.crank_angle_rad, state.park_contact, state.bounce_left, parameters.park_switch)
    current = read_current(state.current_a, state.crank_angle_rad * gear_ratio, state.noise, sensors).current_a
    return Measured(state.motor_speed_rad_s / gear_ratio, current, stick_contact(contact, sensors).shown)


@compiled
def commanded(inputs: Inputs, voltage_v: float, fast: float) -> Inputs:
    """Return the inputs of a tick with a controller's command in them: supply, ON/OFF relay, FAST/SLOW relay."""
    return changed(inputs, Commanded(relay_on=1.0 if voltage_v > 0.0 else 0.0, relay_fast=fast, supply_v=voltage_v))


@compiled
def run_rows(memory: Memory, controller: Controller, tables: Tables, plant: Any, rows: Any) -> Memory:
    """Take one tick for each reference; return what the controller remembers at the end.

    The controller sees the plant at the start of a tick, and its command is in force from there to the next tick.

    Parameters
    ----------
    memory, controller, tables
        See :mod:`hilplant.control.controller`.
    plant
        State row (moves on), parameter row, and tables over the crank angle.
    rows
        Input rows [ticks, inputs], of which supply and relays are the controller's; references [ticks] [rad/s]; output
        rows [ticks, outputs] and trace rows [ticks, len(TRACE)], both filled.

    """
    state_row, parameter_row, plant_tables = plant
    input_rows, references, output_rows, trace_rows = rows
    parameters = unpack(Parameters, parameter_row)
    state = unpack(State, state_row)
    for index in range(references.shape[0]):
        measured = measure(state, parameters)
        memory, command = control(memory, measured, references[index], controller, tables)
        inputs = commanded(unpack(Inputs, input_rows[index]), command.voltage_v, command.fast)
        state, outputs = step(state, inputs, parameters, plant_tables)
        write(outputs, output_rows[index])
        trace_rows[index, 0] = memory.estimate.motor_speed_rad_s / parameters.motor.gear_ratio
        trace_rows[index, 1] = memory.neuron.gain
        trace_rows[index, 2] = memory.estimate.resistance_factor
        trace_rows[index, 3] = memory.neuron.integral
        trace_rows[index, 4] = memory.neuron.proportional
    write(state, state_row)
    return memory


@compiled
def observe_rows(model: Model, period_s: float, adapting: float, records: Any, speeds: Any) -> SpeedEstimate:
    """Run an observer over a recording, and fill `speeds` [ticks] with its crank speeds [rad/s]; return its end.

    `records` is an array [ticks, 3] of the voltage in force from each tick on, the current and the park contact at it.
    """
    estimate = AT_REST
    for index in range(records.shape[0]):
        measured = Measured(0.0, records[index, 1], records[index, 2])
        estimate = learn_resistance(correct(estimate, measured, model), measured.park_contact, model.armature, adapting)
        speeds[index] = estimate.motor_speed_rad_s / model.armature.gear_ratio
        estimate = predict(estimate, records[index, 0], model, period_s)
    return estimate
