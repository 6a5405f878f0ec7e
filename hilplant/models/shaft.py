"""Motor, gear and load together over one step.

Between evaluations of the load the motion is the closed form of :mod:`hilplant.models.armature`. The load is taken
at the angle and the speed that are expected half-way, which makes the error fall with the square of the step, and
friction enters as its tangent, which keeps the step stable however steep the curve is. Where the speed is about to
change much by the measure of the friction curves, which is close to standstill, the step is cut.
"""

import math
from typing import Any, NamedTuple

from hilplant.jit import compiled
from hilplant.models.armature import ArmatureDrive, ArmatureMotion, acceleration
from hilplant.models.circuit import Connection
from hilplant.models.gear import held_torque, through_gear, unloaded
from hilplant.models.load import by_speed, resist_as, without_inertia
from hilplant.models.lookup import find, within_turn
from hilplant.models.motor import Hold, advance, direction_of, slide, stand, stick, within_half_period
from hilplant.models.records import Motor, Parameters
from hilplant.models.resistance import Crank, Resistance
from hilplant.models.torque_network import Tangent
from hilplant.signals import Inputs

#: In one stretch the speed changes by this part of itself at most ...
CHANGE = 0.25
#: ... or of this speed of the crank [rad/s], where it is slower.
SLOW_RAD_S = 0.01

#: The shortest stretch that is chosen, as a part of the step.
SHORTEST = 1.0 / 40.0

#: Stretches in one step, at most: those chosen, and those that end in a stop or a start.
STRETCHES = 64


class Train(NamedTuple):
    """What stays as it is during one step."""

    connection: Connection
    tables: Any
    inputs: Inputs
    parameters: Parameters
    load_mode: float  # who gives the torque of the load, see signals.ACTIVE_MODELS
    tangent: Tangent  # of the torque network, while it does


class Ahead(NamedTuple):
    """How long the next stretch is [s], and what is expected half-way: the motion, and the mean speed."""

    stretch: float
    half_way: ArmatureMotion


class Acting(NamedTuple):
    """What acts on the armature at an instant, and where it turns: 0 while it sticks.

    While it stands, `drive` is what moves the current, and `hold` is that from which it breaks away.
    """

    drive: ArmatureDrive
    hold: Hold
    direction: float


class Joint(NamedTuple):
    """From where motor and linkage are one body in a tick: motion, what acts, the crank's angle, and for how long."""

    motion: ArmatureMotion
    start: Acting
    crank_angle_rad: float
    left_s: float


@compiled
def drive_at(motion: ArmatureMotion, direction: float, load: Resistance, train: Train) -> ArmatureDrive:
    """Return what acts on the armature while it turns in `direction`."""
    return through_gear(load, direction, motion, train.connection, train.parameters.motor)


@compiled
def start_of(motion: ArmatureMotion, load: Resistance, train: Train) -> Acting:
    """Return what acts at an instant."""
    motor = train.parameters.motor
    if motion.speed != 0.0:
        direction = math.copysign(1.0, motion.speed)
        return Acting(drive_at(motion, direction, load, train), Hold(0.0, 0.0), direction)
    drive, hold = unloaded(train.connection, motor), hold_of(load, motor)
    return Acting(drive, hold, direction_of(motion, drive, hold))


@compiled
def load_torque(motion: ArmatureMotion, load: Resistance, start: Acting, train: Train) -> float:
    """Return the torque at the crank [N m], inertia and brake included, positive when it opposes motion.

    At rest it is what the motor presses with through the gear onto the crank, which what holds the crank opposes: the
    motor's torque less its own dry friction, which holds first.
    """
    motor, drive, direction = train.parameters.motor, start.drive, start.direction
    if direction == 0.0:
        pressing = abs(drive.constant * motion.current + drive.push) - motor.coulomb_torque_n_m
        return max(0.0, pressing) * motor.gear_ratio * motor.gear_efficiency
    torque = direction * load.bias + load.dry + load.slope * abs(motion.speed) / motor.gear_ratio
    if load.inertia != 0.0:
        if motion.speed == 0.0:
            drive = drive_at(motion, direction, load, train)
        pull = load.inertia * direction * acceleration(motion, drive, direction * drive.dry_torque)
        torque += pull / motor.gear_ratio
    return torque


@compiled
def hold_of(load: Resistance, motor: Motor) -> Hold:
    """Return the torques from which a standing shaft breaks away."""
    return Hold(held_torque(load, 1.0, motor), held_torque(load, -1.0, motor))


@compiled
def turn(joint: Joint, load: Resistance, train: Train) -> ArmatureMotion:
    """Return the motion at the end of the tick; `load` is that at its start."""
    if not without_inertia(train.parameters):
        return turn_in_stretches(joint, load, train)
    motion, duration, ratio = joint.motion, joint.left_s, train.parameters.motor.gear_ratio
    crank_speed = motion.speed / ratio
    half_way = joint.crank_angle_rad + 0.5 * duration * crank_speed
    parameters = train.parameters
    held = by_speed(half_way, crank_speed, parameters.load, train.inputs, parameters.networks)
    return advance(motion, drive_at(motion, 1.0, held, train), duration)


@compiled
def turn_in_stretches(joint: Joint, load: Resistance, train: Train) -> ArmatureMotion:
    """Return the same with the load evaluated anew in each stretch.

    After `STRETCHES` stretches without an end the shaft stands still for what is left of the step.
    """
    motion, drive, begun = joint.motion, joint.start.drive, joint.motion.turned
    left, ratio, direction = joint.left_s, train.parameters.motor.gear_ratio, 0.0
    if left <= 0.0:
        return motion
    if motion.speed == 0.0:
        motion, taken, direction = let_go(motion, drive, joint.start.hold, left)
        left -= taken
        if left <= 0.0:
            return motion
        drive = drive_at(joint.motion, 1.0, load, train)
    for _ in range(STRETCHES):
        if left <= 0.0:
            return motion
        if motion.speed != 0.0:
            direction = math.copysign(1.0, motion.speed)
        ahead = look_ahead(motion, drive, direction, left, train)
        angle = within_turn(joint.crank_angle_rad + (ahead.half_way.turned - begun) / ratio)
        crank = Crank(train.tables, find(train.tables, angle), angle, ahead.half_way.speed / ratio)
        load = resist_as(train.load_mode, train.tangent, crank, train.parameters, train.inputs)
        if direction == 0.0:
            motion, taken, direction = let_go(motion, drive, hold_of(load, train.parameters.motor), left)
        else:
            drive = drive_at(ahead.half_way, direction, load, train)
            motion, taken = slide(motion, drive, direction, within_half_period(ahead.stretch, drive))
            direction = 0.0
        left -= taken
    return stand(motion, drive, left)


@compiled
def let_go(
    motion: ArmatureMotion, drive: ArmatureDrive, hold: Hold, left: float
) -> tuple[ArmatureMotion, float, float]:
    """Stand still until the motor breaks away or the time is over; return motion, time taken, and direction or 0."""
    direction = direction_of(motion, drive, hold)
    if direction != 0.0:
        return motion, 0.0, direction
    motion, taken = stick(motion, drive, hold, left)
    return motion, taken, direction_of(motion, drive, hold)


@compiled
def look_ahead(motion: ArmatureMotion, drive: ArmatureDrive, direction: float, left: float, train: Train) -> Ahead:
    """Return the next stretch, from the acceleration and its derivative at its start.

    At standstill, direction 0, the middle of the stretch is its start.
    """
    if direction == 0.0:
        return Ahead(left, motion)
    duration, slow = train.parameters.step_s, SLOW_RAD_S * train.parameters.motor.gear_ratio
    back_emf = drive.constant * motion.speed
    rising = (drive.voltage - drive.resistance * motion.current - back_emf) / drive.inductance
    push, jerk = acceleration(motion, drive, direction * drive.dry_torque), drive.constant * rising / drive.inertia
    limit = CHANGE * max(abs(motion.speed), slow)
    stretch = left
    if left * (abs(push) + 0.5 * abs(jerk) * left) > limit:
        stretch = 2.0 * limit / (abs(push) + math.sqrt(push * push + 2.0 * abs(jerk) * limit))
        stretch = min(left, max(SHORTEST * duration, stretch))
    mean = motion.speed + stretch * (0.5 * push + stretch * jerk / 6.0)
    turned = motion.turned + 0.5 * stretch * (motion.speed + 0.25 * stretch * push)
    half_way = ArmatureMotion(motion.current + 0.5 * stretch * rising, mean if direction * mean > 0.0 else 0.0, turned)
    return Ahead(stretch, half_way)
