"""Play between crank and linkage: two bodies that touch at one flank or the other, or move apart from each other.

The linkage is ahead of the crank by an angle from 0, where the crank pushes it forwards, to the backlash b, where it is
pushed backwards. While they touch they are one body, as without play, for as long as the torque between them pushes;
at the instant from which it would pull they part. Apart, the motor turns without load and the linkage moves by itself,

    M dw/dt + s [M' w^2/2 + G + V^2 D + friction] + B w = 0.

They meet within a tick at the instant that follows from straight lines; there both take the speed v at which the sum of
their momenta is kept, (J n^2 + M) v = J n^2 w(crank) + M w(linkage), without rebound and without the gear's friction
(assumed); the rest of the tick they are one. The park cam and the shown crank angle belong to the motor's side.
"""

import math
from typing import Any, NamedTuple

from hilplant.jit import compiled, compiled_apart
from hilplant.models.armature import ArmatureMotion, acceleration, glide
from hilplant.models.gear import through_gear
from hilplant.models.lookup import find, within_turn
from hilplant.models.mechanical_records import PlayState
from hilplant.models.motor import advance
from hilplant.models.records import Motor, Parameters, State
from hilplant.models.resistance import Crank, Resistance
from hilplant.models.shaft import Acting, Joint, Train, load_torque, start_of

#: Evaluations in the search for the instant at which they part.
SEARCHES = 5
#: The search begins where the torque between them would change its sign within this many ticks at its present rate.
AHEAD = 2.0
#: Speed of the motor [rad/s] and current [A] below which it stands, apart from the linkage.
NOTHING_LEFT = 1e-9


class Apart(NamedTuple):
    """Where the linkage has come to after a while on its own: turned [rad] and speed [rad/s], as of its crank."""

    turned: float
    speed: float


@compiled
def linkage_crank(speed_rad_s: float, state: State, parameters: Parameters, tables: Any) -> Crank:
    """Return where the linkage is and how fast it moves, as of its crank; `speed_rad_s` is that of the motor's."""
    angle, speed = state.crank_angle_rad, speed_rad_s
    if parameters.linkage.altered > 0.5:
        angle = within_turn(angle + min(state.play.ahead_rad, parameters.linkage.backlash_rad))
        if state.play.apart > 0.5:
            speed = state.play.speed_rad_s
    return Crank(tables, find(tables, angle), angle, speed)


@compiled
def join(whole: Joint, linkage: Crank, load: Resistance, train: Train, now: PlayState) -> tuple[Joint, PlayState]:
    """Return where in this tick motor and linkage become one body, and the linkage in its play at the tick's end.

    `load` is that of the linkage at the start. Without play they are one from the start on, as `whole` has them.
    """
    if train.parameters.linkage.altered < 0.5 or train.parameters.linkage.backlash_rad <= 0.0:
        return whole, PlayState(0.0, 0.0, 0.0)
    return join_with_play(whole, linkage, load, train, now)


@compiled_apart
def join_with_play(
    whole: Joint, linkage: Crank, load: Resistance, train: Train, now: PlayState
) -> tuple[Joint, PlayState]:
    """Return the same where there is play; of a tick that they spend apart nothing is left for the one body."""
    motion, width, step_s = whole.motion, train.parameters.linkage.backlash_rad, train.parameters.step_s
    ahead, parted, free = min(now.ahead_rad, width), 0.0, Apart(0.0, linkage.speed_rad_s)
    if now.apart < 0.5:
        parted = parting(whole, load, train, ahead)
        if parted >= step_s:
            return whole, PlayState(ahead, 0.0, 0.0)
    motor, turned = train.parameters.motor, motion.turned
    if parted > 0.0:
        drive = whole.start.drive
        motion = glide(motion, drive, whole.start.direction * drive.dry_torque, parted)
        free = Apart((motion.turned - turned) / motor.gear_ratio, motion.speed / motor.gear_ratio)
    nothing, left = Resistance(0.0, 0.0, 0.0, 0.0), step_s - parted
    drive = through_gear(nothing, math.copysign(1.0, motion.speed), motion, train.connection, motor)
    alone, moved = advance(motion, drive, left), on_its_own(free, load, left)
    gap = ahead + moved.turned - (alone.turned - turned) / motor.gear_ratio
    if 0.0 < gap < width:
        return Joint(run_down(alone), whole.start, linkage.angle_rad, 0.0), PlayState(gap, moved.speed, 1.0)
    flank = 0.0 if gap <= 0.0 else width
    taken = left * min(1.0, max(0.0, (flank - ahead) / (gap - ahead))) if gap != ahead else left
    alone, moved = advance(motion, drive, taken), on_its_own(free, load, taken)
    own = motor.inertia_kg_m2 * motor.gear_ratio * motor.gear_ratio
    common = (own * alone.speed / motor.gear_ratio + load.inertia * moved.speed) / (own + load.inertia)
    met = ArmatureMotion(alone.current, common * motor.gear_ratio, alone.turned)
    joint = Joint(met, start_of(met, load, train), within_turn(linkage.angle_rad + moved.turned), left - taken)
    return joint, PlayState(flank, 0.0, 0.0)


@compiled
def parting(whole: Joint, load: Resistance, train: Train, ahead_rad: float) -> float:
    """Return when in the tick crank and linkage, which touch, part [s]: 0 at once, the whole tick if they do not.

    They part where the torque between them would pull. Within the tick current and speed are those of one body with
    the load as it is at the start; false position with the end that stays halved (Illinois), `SEARCHES` evaluations.
    """
    motion, start, step_s = whole.motion, whole.start, train.parameters.step_s
    if motion.speed == 0.0:
        return step_s if held_together(motion, load, train, ahead_rad) else 0.0
    side = -1.0 if ahead_rad > 0.0 else 1.0
    pressing, drive = side * start.direction * load_torque(motion, load, start, train), start.drive
    if pressing < 0.0:
        return 0.0
    torque = start.direction * drive.dry_torque
    rise = rising(motion, load, start, train.parameters.motor)
    if pressing + AHEAD * step_s * min(0.0, side * rise) >= 0.0:
        return step_s
    low, high, at_low, at_high, at = 0.0, step_s, pressing, 0.0, step_s
    for _ in range(SEARCHES):
        point = glide(motion, drive, torque, at)
        if start.direction * point.speed <= 0.0:
            return step_s
        force = side * start.direction * load_torque(point, load, start, train)
        if force >= 0.0:
            if at == step_s:
                return step_s
            low, at_low, at_high = at, force, 0.5 * at_high
        else:
            high, at_high, at_low = at, force, 0.5 * at_low if low > 0.0 else at_low
        at = low + (high - low) * at_low / (at_low - at_high)
    return at


@compiled
def rising(motion: ArmatureMotion, load: Resistance, start: Acting, motor: Motor) -> float:
    """Return the rate at which the torque between crank and linkage rises, in the wiping direction [N m/s]."""
    drive = start.drive
    push = acceleration(motion, drive, start.direction * drive.dry_torque)
    current = (drive.voltage - drive.resistance * motion.current - drive.constant * motion.speed) / drive.inductance
    jerk = (drive.constant * current - drive.damping * push) / drive.inertia
    return (load.slope * push + load.inertia * jerk) / motor.gear_ratio


@compiled
def held_together(motion: ArmatureMotion, load: Resistance, train: Train, ahead_rad: float) -> bool:
    """Return whether a motor at rest and the linkage stay together at the flank where they are."""
    brush, second = train.connection.brush, train.connection.second
    constant = brush.constant_v_s if train.connection.closed > 0.5 else 0.0
    pull = constant * motion.current + second.push_n_m
    free = abs(pull) > train.parameters.motor.coulomb_torque_n_m and (pull < 0.0) != (ahead_rad > 0.0)
    falls = abs(load.bias) > load.dry and (load.bias < 0.0) != (ahead_rad > 0.0)
    return not free and not falls


@compiled
def run_down(alone: ArmatureMotion) -> ArmatureMotion:
    """Return the motor, which without dry friction would never stand in the play, at rest once nothing is left."""
    if max(abs(alone.speed), abs(alone.current)) < NOTHING_LEFT:
        return ArmatureMotion(0.0, 0.0, alone.turned)
    return alone


@compiled
def on_its_own(before: Apart, load: Resistance, time: float) -> Apart:
    """Return how the linkage moves without the crank; without inertia it stays where it is.

    Friction and damping may stop it but not turn it round; the damping is exact for the load at the tick's start.
    """
    speed = before.speed
    direction = math.copysign(1.0, speed) if speed != 0.0 else -math.copysign(1.0, load.bias)
    if load.inertia <= 0.0 or (speed == 0.0 and abs(load.bias) <= load.dry):
        return Apart(before.turned, 0.0)
    following = speed - time * (load.bias + direction * load.dry) / load.inertia
    following /= 1.0 + time * load.slope / load.inertia
    if direction * following < 0.0:
        following = 0.0
    return Apart(before.turned + 0.5 * time * (speed + following), following)
