"""Play between crank and linkage: two bodies that touch at one flank or the other, or move apart from each other.

The linkage is ahead of the crank by an angle from 0, where the crank pushes it forwards, to the backlash b, where it is
pushed backwards. While they touch they are one body, as without play, for as long as the torque between them pushes;
where it would pull they part. Apart, the motor turns without load and the linkage moves by itself,

    M dw/dt + s [M' w^2/2 + G + V^2 D + friction] + B w = 0.

They meet within a tick at the instant that follows from straight lines; there both take the speed v at which the sum of
their momenta is kept, (J n^2 + M) v = J n^2 w(crank) + M w(linkage), without rebound and without the gear's friction
(assumed); the rest of the tick they are one. The park cam and the shown crank angle belong to the motor's side.
"""

import math
from typing import Any, NamedTuple

from hilplant.jit import compiled, compiled_apart
from hilplant.models.armature import ArmatureMotion
from hilplant.models.gear import through_gear
from hilplant.models.lookup import find, within_turn
from hilplant.models.mechanical_records import PlayState
from hilplant.models.motor import advance
from hilplant.models.records import Parameters, State
from hilplant.models.resistance import Crank, Resistance
from hilplant.models.shaft import Joint, Train, load_torque


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
def join(
    motion: ArmatureMotion, linkage: Crank, load: Resistance, train: Train, now: PlayState
) -> tuple[Joint, PlayState]:
    """Return where in this tick motor and linkage become one body, and the linkage in its play at the tick's end.

    `load` is that of the linkage at the start. Without play they are one from the start on.
    """
    if train.parameters.linkage.altered < 0.5 or train.parameters.linkage.backlash_rad <= 0.0:
        return Joint(motion, linkage.angle_rad, train.parameters.step_s), PlayState(0.0, 0.0, 0.0)
    return join_with_play(motion, linkage, load, train, now)


@compiled_apart
def join_with_play(
    motion: ArmatureMotion, linkage: Crank, load: Resistance, train: Train, now: PlayState
) -> tuple[Joint, PlayState]:
    """Return the same where there is play; of a tick that they spend apart nothing is left for the one body."""
    width, step_s = train.parameters.linkage.backlash_rad, train.parameters.step_s
    ahead = min(now.ahead_rad, width)
    if now.apart < 0.5 and pushes(motion, load, train, ahead):
        return Joint(motion, linkage.angle_rad, step_s), PlayState(ahead, 0.0, 0.0)
    motor, nothing, taken = train.parameters.motor, Resistance(0.0, 0.0, 0.0, 0.0), step_s
    drive = through_gear(nothing, math.copysign(1.0, motion.speed), motion, train.connection, motor)
    alone, free, flank = motion, Apart(0.0, 0.0), 0.0
    for attempt in range(2):  # to the end of the tick; then to where they meet, if they do
        alone, free = advance(motion, drive, taken), on_its_own(linkage, load, taken)
        if attempt == 0:
            gap = ahead + free.turned - (alone.turned - motion.turned) / motor.gear_ratio
            if 0.0 < gap < width:
                return Joint(alone, linkage.angle_rad, 0.0), PlayState(gap, free.speed, 1.0)
            flank = 0.0 if gap <= 0.0 else width
            taken = step_s * min(1.0, max(0.0, (flank - ahead) / (gap - ahead))) if gap != ahead else step_s
    own = motor.inertia_kg_m2 * motor.gear_ratio * motor.gear_ratio
    common = (own * alone.speed / motor.gear_ratio + load.inertia * free.speed) / (own + load.inertia)
    met = ArmatureMotion(alone.current, common * motor.gear_ratio, alone.turned)
    return Joint(met, within_turn(linkage.angle_rad + free.turned), step_s - taken), PlayState(flank, 0.0, 0.0)


@compiled
def pushes(motion: ArmatureMotion, load: Resistance, train: Train, ahead_rad: float) -> bool:
    """Return whether crank and linkage, which touch, press on each other at the flank where they are."""
    direction = math.copysign(1.0, motion.speed)
    if motion.speed == 0.0:
        brush, second = train.connection.brush, train.connection.second
        constant = brush.constant_v_s if train.connection.closed > 0.5 else 0.0
        pull = constant * motion.current + second.push_n_m
        free = abs(pull) > train.parameters.motor.coulomb_torque_n_m and (pull < 0.0) != (ahead_rad > 0.0)
        falls = abs(load.bias) > load.dry and (load.bias < 0.0) != (ahead_rad > 0.0)
        return not free and not falls
    forwards = direction * load_torque(motion, load, train)
    return forwards <= 0.0 if ahead_rad > 0.0 else forwards >= 0.0


@compiled
def on_its_own(linkage: Crank, load: Resistance, time: float) -> Apart:
    """Return how the linkage moves without the crank; without inertia it stays where it is.

    Implicit in friction and damping, which may stop it but not turn it round.
    """
    speed = linkage.speed_rad_s
    direction = math.copysign(1.0, speed) if speed != 0.0 else -math.copysign(1.0, load.bias)
    if load.inertia <= 0.0 or (speed == 0.0 and abs(load.bias) <= load.dry):
        return Apart(0.0, 0.0)
    following = speed - time * (load.bias + direction * load.dry) / load.inertia
    following /= 1.0 + time * load.slope / load.inertia
    if direction * following < 0.0:
        following = 0.0
    return Apart(0.5 * time * (speed + following), following)
