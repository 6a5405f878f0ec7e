"""Physical motor or motor network, tick by tick, and the guard that decides which of the two is active.

The network is active while the inputs of this tick and of the one before, and what it answers, lie within its
training. Otherwise the physical model moves the motor in the same tick from the same state. The memory of both is the
same, two ticks of voltage, torque, current and speed, so the network goes on from what the physical model has left.
"""

import math

from hilplant.jit import compiled
from hilplant.models.armature import ArmatureMotion
from hilplant.models.narx import (
    FAST_BRUSH,
    NETWORK,
    NO_BRUSH,
    OUTSIDE,
    PHYSICAL,
    RETURN_MARGIN,
    SLOW_BRUSH,
    STANDSTILL,
    path_of,
    predict,
    within,
)
from hilplant.models.records import MotorMemory, Sample, State
from hilplant.models.resistance import Resistance
from hilplant.models.shaft import Joint, Train, drive_at, turn
from hilplant.models.training import motor_altered

#: Names of the models of the motor; ``Parameters.motor_model`` is the place in this list.
MOTORS = ("ode", "narx")
NARX = MOTORS.index("narx")


@compiled
def move(joint: Joint, load: Resistance, train: Train, state: State) -> tuple[ArmatureMotion, MotorMemory]:
    """Return the motion a step later and what is remembered of this one; `load` is that at the start.

    Where motor and linkage are not one body from the tick's start on, the network is not active.
    """
    motion = joint.motion
    memory, after, accepted = without_network(PHYSICAL), motion, False
    if train.parameters.motor_model == NARX:
        memory, after = by_network(motion, load, train, state)
        accepted = memory.mode == NETWORK
    if not accepted:
        after = turn(joint, load, train)
        if train.parameters.motor_model == NARX:
            memory = remembered(motion, after, memory.mode, train)
    return after, memory


@compiled
def by_network(
    motion: ArmatureMotion, load: Resistance, train: Train, state: State
) -> tuple[MotorMemory, ArmatureMotion]:
    """Return the network's answer; or in `MotorMemory.mode` why it has none."""
    networks, brush = train.parameters.networks, brush_of(train)
    path = path_of(networks, brush if brush != NO_BRUSH else SLOW_BRUSH)
    before = state.memory.last
    speed = motion.speed / train.parameters.motor.gear_ratio
    now = Sample(train.connection.terminal_v, state.memory.last.torque_n_m, motion.current, speed)
    if motor_altered(train.parameters):
        return without_network(OUTSIDE), motion
    if brush == NO_BRUSH or speed < networks[path + 4]:
        return without_network(STANDSTILL), motion
    if state.memory.brush != brush:
        outside = state.memory.brush == NO_BRUSH and state.memory.mode == OUTSIDE
        return without_network(OUTSIDE if outside else STANDSTILL), motion
    margin = 0.0 if state.memory.mode == NETWORK else RETURN_MARGIN
    if margin > 0.0 and not within(networks, path, before, margin):
        return without_network(OUTSIDE), motion
    now, after = coupled(now, before, load, train, path)
    reached = Sample(now.terminal_v, now.torque_n_m, after.current, after.speed / train.parameters.motor.gear_ratio)
    if not (within(networks, path, now, margin) and within(networks, path, reached, 0.0)):
        return without_network(OUTSIDE), motion
    return MotorMemory(now, brush, NETWORK), after


@compiled
def without_network(mode: float) -> MotorMemory:
    """Return the memory that the network cannot go on from."""
    return MotorMemory(Sample(0.0, 0.0, 0.0, 0.0), brush=NO_BRUSH, mode=mode)


@compiled
def coupled(now: Sample, before: Sample, load: Resistance, train: Train, path: int) -> tuple[Sample, ArmatureMotion]:
    """Return the sample with the torque that the load needs for the speed that the network answers to it.

    The torque contains the load's inertia, which is of the size of the motor's own, so it must be that of the
    acceleration in this very tick. Both are straight lines to a good approximation: the torque over the speed at the
    end of the tick, exactly, and the answer over the torque, about the torque of the tick before. Their crossing is
    the answer: no iteration. Whether the load drives or is driven is taken as it is half-way.
    """
    ratio, step_s = train.parameters.motor.gear_ratio, train.parameters.step_s
    motor, speed = train.parameters.motor, now.speed_rad_s
    answer = predict(train.parameters.networks, path, now, before)
    half_way = ArmatureMotion(0.5 * (now.current_a + answer.current_a), 0.5 * ratio * (speed + answer.speed_rad_s), 0.0)
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
    after = ArmatureMotion(current, final * ratio, 0.5 * step_s * ratio * (speed + final))
    return Sample(now.terminal_v, torque, now.current_a, speed), after


@compiled
def brush_of(train: Train) -> float:
    """Return which brush is in the circuit."""
    if train.connection.closed < 0.5:
        return NO_BRUSH
    return FAST_BRUSH if train.connection.fast > 0.5 else SLOW_BRUSH


@compiled
def remembered(before: ArmatureMotion, after: ArmatureMotion, mode: float, train: Train) -> MotorMemory:
    """Return what a tick of the physical model leaves to the network, with the mean torque through the gear.

    That torque is what the integrals of (3.30) and (3.31) over the tick leave for it.
    """
    brush, ratio = brush_of(train), train.parameters.motor.gear_ratio
    if brush == NO_BRUSH or after.speed <= 0.0 or motor_altered(train.parameters):
        return without_network(mode)
    torque = carried_torque(before, after, train)
    sample = Sample(train.connection.terminal_v, torque, before.current, before.speed / ratio)
    if not within(train.parameters.networks, path_of(train.parameters.networks, brush), sample, 0.0):
        brush = NO_BRUSH
    return MotorMemory(sample, brush, mode)


@compiled
def carried_torque(before: ArmatureMotion, after: ArmatureMotion, train: Train) -> float:
    """Return the mean torque through the gear between two instants a step apart, at the crank [N m]."""
    motor, brush, step_s = train.parameters.motor, train.connection.brush, train.parameters.step_s
    turned = after.turned - before.turned
    flux = brush.inductance_henry * (after.current - before.current)
    charge = (train.connection.terminal_v * step_s - brush.constant_v_s * turned - flux) / brush.resistance_ohm
    momentum = motor.inertia_kg_m2 * (after.speed - before.speed)
    dry = math.copysign(motor.coulomb_torque_n_m, after.speed) * step_s
    impulse = brush.constant_v_s * charge - motor.damping_n_m_s * turned - momentum - dry
    return impulse / step_s * motor.gear_ratio
