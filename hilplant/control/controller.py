"""One tick of any velocity controller: a pure function of memory, measurement, reference and parameters."""

import math
from typing import Any, NamedTuple

from hilplant.control.network import network_speed
from hilplant.control.observer import correct, learn_resistance, predict, voltage_for
from hilplant.control.pid import pid
from hilplant.control.records import (
    LAWS,
    POWER_ON,
    SOURCES,
    Command,
    Controller,
    Measured,
    Memory,
    PidMemory,
    SpeedEstimate,
)
from hilplant.control.single_neuron import single_neuron
from hilplant.control.stages import choose_stage
from hilplant.jit import compiled

PID, CASCADE = float(LAWS.index("pid")), float(LAWS.index("cascade"))
SENSOR, NETWORK, OBSERVER = (float(index) for index in range(len(SOURCES)))


class Tables(NamedTuple):
    """Arrays that a controller reads: K of the fuzzy system, and the paths of the speed network, one a brush."""

    gain: Any
    slow_path: Any
    fast_path: Any


@compiled
def control(
    memory: Memory, measured: Measured, reference_rad_s: float, controller: Controller, tables: Tables
) -> tuple[Memory, Command]:
    """Return the memory, and the command for the time until the next tick.

    Parameters
    ----------
    memory
        From the last tick; ``POWER_ON`` before the first.
    measured
        At this instant; not-a-number where nothing has come. The cascade then goes on with what its observer
        expects; the others keep their voltage.
    reference_rad_s
        Wanted speed of the crank [rad/s]; 0 or less commands no voltage and forgets.
    controller, tables
        Fixed for the run; arrays as :class:`Tables`.

    """
    if not reference_rad_s > 0.0:
        return POWER_ON, Command(controller.lowest_v, 0.0)
    model = controller.fast if memory.stage.fast > 0.5 else controller.slow
    estimate = correct(memory.estimate, measured, model)
    estimate = learn_resistance(estimate, measured.park_contact, model.armature, controller.adapting)
    speed = speed_seen(memory, measured, estimate, controller, tables)
    pid_memory, neuron_memory = memory.pid, memory.neuron
    if controller.law == CASCADE:
        wanted = voltage_for(estimate, reference_rad_s, model.armature, controller.cascade)
        voltage = min(max(wanted, controller.lowest_v), controller.highest_v)
    elif not math.isfinite(speed):
        voltage = memory.voltage_v
    elif controller.law == PID:
        pid_memory, voltage = pid(memory.pid, speed, reference_rad_s, controller)
    else:
        error = reference_rad_s - speed
        neuron_memory, voltage = single_neuron(memory.neuron, memory.voltage_v, error, controller, tables.gain)
    stage, factor = choose_stage(memory.stage, voltage, reference_rad_s, controller)
    if factor != 1.0:
        voltage = min(max(voltage * factor, controller.lowest_v), controller.highest_v)
        pid_memory = PidMemory(pid_memory.integral_v * factor, pid_memory.error)
    model = controller.fast if stage.fast > 0.5 else controller.slow
    estimate = predict(estimate, voltage, model, controller.period_s)
    return Memory(voltage, stage, pid_memory, neuron_memory, estimate), Command(voltage, stage.fast)


@compiled
def speed_seen(
    memory: Memory, measured: Measured, estimate: SpeedEstimate, controller: Controller, tables: Tables
) -> float:
    """Return the crank's speed [rad/s] from the sensor, the network or the observer.

    Network and observer use the voltage that was in force until now, which is the one that made the current.
    """
    if controller.source == SENSOR:
        return measured.speed_rad_s
    if controller.source == OBSERVER:
        return estimate.motor_speed_rad_s / controller.slow.armature.gear_ratio
    path = tables.fast_path if memory.stage.fast > 0.5 else tables.slow_path
    return network_speed(memory.voltage_v, measured.current_a, path)
