"""Physical motor or motor network, tick by tick, and the guard that decides which of the two is in charge.

The network is in charge while the inputs of this tick and of the one before, and what it answers, lie within its
training. Otherwise the physical model moves the motor in the same tick from the same state. The memory of both is the
same, two ticks of voltage, torque, current and speed, so the network goes on from what the physical model has left.
"""

import math
from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models.armature import Motion
from hilplant.models.load import Resistance
from hilplant.models.narx import (
    FAST_BRUSH,
    NETWORK,
    NO_BRUSH,
    OUTSIDE,
    PHYSICAL,
    RETURN_MARGIN,
    SLOW_BRUSH,
    STANDSTILL,
    Sample,
    path_of,
    predict,
    within,
)
from hilplant.models.records import State
from hilplant.models.shaft import Train, drive_at, turn

#: Names of the models of the motor; ``Parameters.motor_model`` is the place in this list.
MOTORS = ("ode", "narx")
NARX = MOTORS.index("narx")


class Memory(NamedTuple):
    """What a tick leaves to the next one; ``State`` ends with it."""

    terminal_v: float
    torque_n_m: float
    current_a: float
    speed_rad_s: float
    brush: float  # NO_BRUSH where the four are not within the training
    mode: float


NOTHING = Memory(0.0, 0.0, 0.0, 0.0, NO_BRUSH, PHYSICAL)


@compiled
def move(motion: Motion, crank_angle_rad: float, load: Resistance, train: Train, state: State) -> tuple[Motion, Memory]:
    """Return the motion a step later and what is remembered of this one; `load` is that at the start."""
    memory, after, accepted = NOTHING, motion, False
    if train.parameters.motor_model == NARX:
        memory, after = by_network(motion, load, train, state)
        accepted = memory.mode == NETWORK
    if not accepted:
        after = turn(motion, crank_angle_rad, load, train)
        if train.parameters.motor_model == NARX:
            memory = remembered(motion, after, memory.mode, train)
    return after, memory


@compiled
def by_network(motion: Motion, load: Resistance, train: Train, state: State) -> tuple[Memory, Motion]:
    """Return the network's answer; or in `Memory.mode` why it has none."""
    networks, brush = train.parameters.networks, brush_of(train)
    path = path_of(networks, brush if brush != NO_BRUSH else SLOW_BRUSH)
    before = Sample(state.last_terminal_v, state.last_torque_n_m, state.last_current_a, state.last_speed_rad_s)
    speed = motion.speed / train.parameters.motor.gear_ratio
    now = Sample(train.connection.terminal_v, state.last_torque_n_m, motion.current, speed)
    if brush == NO_BRUSH or speed < networks[path + 4]:
        return without_network(STANDSTILL), motion
    if state.last_brush != brush:
        outside = state.last_brush == NO_BRUSH and state.motor_mode == OUTSIDE
        return without_network(OUTSIDE if outside else STANDSTILL), motion
    margin = 0.0 if state.motor_mode == NETWORK else RETURN_MARGIN
    if margin > 0.0 and not within(networks, path, before, margin):
        return without_network(OUTSIDE), motion
    now, after = coupled(now, before, load, train, path)
    reached = Sample(now.terminal_v, now.torque_n_m, after.current, after.speed / train.parameters.motor.gear_ratio)
    if not (within(networks, path, now, margin) and within(networks, path, reached, 0.0)):
        return without_network(OUTSIDE), motion
    return Memory(now.terminal_v, now.torque_n_m, now.current_a, now.speed_rad_s, brush, NETWORK), after


@compiled
def without_network(mode: float) -> Memory:
    """Return the memory that the network cannot go on from."""
    return Memory(0.0, 0.0, 0.0, 0.0, NO_BRUSH, mode)


@compiled
def coupled(now: Sample, before: Sample, load: Resistance, train: Train, path: int) -> tuple[Sample, Motion]:
    """Return the sample with the torque that the load needs for the speed that the network answers to it.

    The torque contains the load's inertia, which is of the size of the motor's own, so it must be that of the
    acceleration in this very tick. Both are straight lines to a good approximation: the torque over the speed at the
    end of the tick, exactly, and the answer over the torque, about the torque of the tick before. Their crossing is
    the answer: no iteration. Whether the load drives or is driven is taken as it is half-way.
    """
    ratio, step_s = train.parameters.motor.gear_ratio, train.parameters.step_s
    motor, speed = train.parameters.motor, now.speed_rad_s
    answer = predict(train.parameters.networks, path, now, before)
    half_way = Motion(0.5 * (now.current_a + answer.current_a), 0.5 * ratio * (speed + answer.speed_rad_s), 0.0)
    drive = drive_at(half_way, 1.0, load, train)
    inertia = (drive.inertia - motor.inertia_kg_m2) * ratio * ratio / step_s
    damping = (drive.damping - motor.damping_n_m_s) * ratio * ratio
    dry = (drive.dry_torque - motor.coulomb_torque_n_m) * ratio
    by_speed = inertia + 0.5 * damping
    at_zero = dry + (0.5 * damping - inertia) * speed
    final = answer.speed_rad_s + answer.speed_by_torque * (at_zero - now.torque_n_m)
    final /= 1.0 - answer.speed_by_torque * by_speed
    torque = at_zero + by_speed * final
    current = answer.current_a + answer.current_by_torque * (torque - now.torque_n_m)
    after = Motion(current, final * ratio, 0.5 * step_s * ratio * (speed + final))
    return Sample(now.terminal_v, torque, now.current_a, speed), after


@compiled
def brush_of(train: Train) -> float:
    """Return which brush is in the circuit."""
    brush, fast = train.connection.brush, train.parameters.motor.fast
    if train.connection.closed < 0.5:
        return NO_BRUSH
    same = brush.constant_v_s == fast.constant_v_s and brush.resistance_ohm == fast.resistance_ohm
    return FAST_BRUSH if same and brush.inductance_henry == fast.inductance_henry else SLOW_BRUSH


@compiled
def remembered(before: Motion, after: Motion, mode: float, train: Train) -> Memory:
    """Return what a tick of the physical model leaves to the network, with the mean torque through the gear.

    That torque is what the integrals of (3.30) and (3.31) over the tick leave for it.
    """
    brush, ratio = brush_of(train), train.parameters.motor.gear_ratio
    if brush == NO_BRUSH or after.speed <= 0.0:
        return without_network(mode)
    torque = carried_torque(before, after, train)
    sample = Sample(train.connection.terminal_v, torque, before.current, before.speed / ratio)
    if not within(train.parameters.networks, path_of(train.parameters.networks, brush), sample, 0.0):
        brush = NO_BRUSH
    return Memory(sample.terminal_v, torque, before.current, sample.speed_rad_s, brush, mode)


@compiled
def carried_torque(before: Motion, after: Motion, train: Train) -> float:
    """Return the mean torque through the gear between two instants a step apart, at the crank [N m]."""
    motor, brush, step_s = train.parameters.motor, train.connection.brush, train.parameters.step_s
    turned = after.turned - before.turned
    flux = brush.inductance_henry * (after.current - before.current)
    charge = (train.connection.terminal_v * step_s - brush.constant_v_s * turned - flux) / brush.resistance_ohm
    momentum = motor.inertia_kg_m2 * (after.speed - before.speed)
    dry = math.copysign(motor.coulomb_torque_n_m, after.speed) * step_s
    impulse = brush.constant_v_s * charge - motor.damping_n_m_s * turned - momentum - dry
    return impulse / step_s * motor.gear_ratio
