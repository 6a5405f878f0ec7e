"""One step of the two-speed motor with dry friction, where standing still is an event and not a steep curve.

Between events the motion is linear and known in closed form (:mod:`hilplant.models.armature`). While it slides, dry
friction is a constant torque against the motion; when the speed comes to zero the shaft sticks, and only the current
moves, until the motor's torque exceeds the dry torque. So a shaft at rest is at exactly zero speed, without creep or
chatter, and friction takes energy out or does nothing.
"""

import math
from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models.armature import ArmatureDrive, ArmatureMotion, acceleration, glide

#: Stretches of sliding or sticking in one step, at most; a stop and a new start take three.
STRETCHES = 24

#: Evaluations of the motion in one search for an instant, at most: enough for bisection to the last bits.
SEARCH_CAP = 80

#: Times are found to this part of the stretch in which they lie.
SEARCH_TOLERANCE = 1e-14

#: A stretch whose square times that of the angular frequency is below this is shorter than a half period: below pi^2.
CERTAINLY_SHORTER = 9.0


class Hold(NamedTuple):
    """Torques of the motor [N m] from which a standing shaft breaks away, forwards and backwards.

    Friction holds at least as much as a load pulls, so their sum is not negative; one of them may be.
    """

    forwards: float
    backwards: float


@compiled
def advance(motion: ArmatureMotion, drive: ArmatureDrive, duration: float) -> ArmatureMotion:
    """Return the motion after `duration` [s] against a dry torque that is the same in both directions.

    After `STRETCHES` stretches without an end the shaft stands still for what is left of the step: the answer
    that adds no energy. Costs one exponential of the matrix, and some ten more for each event.
    """
    if drive.dry_torque == 0.0 and drive.push == 0.0:
        return glide(motion, drive, 0.0, duration)
    hold = Hold(drive.dry_torque, drive.dry_torque)
    left, swings = duration, 0
    for _ in range(STRETCHES):
        direction = direction_of(motion, drive, hold)
        if direction == 0.0:
            motion, taken = stick(motion, drive, hold, left)
        else:
            # an oscillation decays: if its first period does not bring the speed to zero, nothing after it does
            stretch = within_half_period(left, drive) if swings < 2 else left
            motion, taken = slide(motion, drive, direction, stretch)
        swings = swings + 1 if motion.speed != 0.0 else 0
        left -= taken
        if left <= 0.0:
            return motion
    return stand(motion, drive, left)


@compiled
def direction_of(motion: ArmatureMotion, drive: ArmatureDrive, hold: Hold) -> float:
    """Return +1 or -1 while the shaft turns or breaks away, 0 while it sticks."""
    if motion.speed != 0.0:
        return math.copysign(1.0, motion.speed)
    torque = drive.constant * motion.current + drive.push
    if torque > hold.forwards:
        return 1.0
    return -1.0 if -torque > hold.backwards else 0.0


@compiled
def stand(motion: ArmatureMotion, drive: ArmatureDrive, time: float) -> ArmatureMotion:
    """Return the motion after `time` at standstill; without a circuit there is no current."""
    if drive.constant == 0.0:
        return ArmatureMotion(0.0, 0.0, motion.turned)
    final = drive.voltage / drive.resistance
    current = final + (motion.current - final) * math.exp(-time * drive.resistance / drive.inductance)
    return ArmatureMotion(current, 0.0, motion.turned)


@compiled
def stick(motion: ArmatureMotion, drive: ArmatureDrive, hold: Hold, left: float) -> tuple[ArmatureMotion, float]:
    """Stand still until the motor breaks away or the time is over; return the motion and the time taken.

    The current approaches V/R without overshoot, so the instant at which K i reaches the held torque is a
    logarithm. There the current is set a few bits beyond, so that what follows sees a sliding shaft.
    """
    final = drive.voltage / drive.resistance
    torque = drive.constant * final + drive.push
    if torque > hold.forwards or -torque > hold.backwards:
        held = hold.forwards if torque > hold.forwards else -hold.backwards
        threshold = (held - drive.push) / drive.constant
        ratio = (final - motion.current) / (final - threshold)
        wait = math.log(max(1.0, ratio)) * drive.inductance / drive.resistance
        if wait < left:
            return ArmatureMotion(threshold + 1e-15 * (final - threshold + abs(threshold) * math.copysign(1.0, torque)),
                          0.0, motion.turned), wait  # fmt: skip
    return stand(motion, drive, left), left


@compiled
def slide(motion: ArmatureMotion, drive: ArmatureDrive, sign: float, stretch: float) -> tuple[ArmatureMotion, float]:
    """Slide in the direction `sign` until the speed comes to zero or the stretch is over; return motion and time taken.

    A dry torque below zero, of a load that pulls, drives the shaft in that direction.
    """
    torque = sign * drive.dry_torque
    end = glide(motion, drive, torque, stretch)
    below = stretch
    if sign * end.speed >= 0.0:
        below = instant_below_zero(motion, drive, sign, stretch) if dips(motion, end, drive, sign) else 0.0
        if below == 0.0:
            return end, stretch
    instant = instant_of_zero(motion, drive, sign, below)
    stop = glide(motion, drive, torque, instant)
    return ArmatureMotion(stop.current, 0.0, stop.turned), instant


@compiled
def dips(start: ArmatureMotion, end: ArmatureMotion, drive: ArmatureDrive, sign: float) -> bool:
    """Return whether the speed may have changed its sign between two ends at which it has the same.

    It cannot while the motor's torque exceeds the dry torque, and while the speed falls the torque stays above it
    if the voltage, less the back-EMF at the start, can drive that much current. Else it takes a speed that falls at
    the start and rises at the end.
    """
    dry = drive.dry_torque - sign * drive.push
    lasting = sign * (drive.voltage - drive.constant * start.speed) * drive.constant > drive.resistance * dry
    if lasting and sign * drive.constant * start.current > dry:
        return False
    falls = sign * acceleration(start, drive, sign * drive.dry_torque) < 0.0
    return falls and sign * acceleration(end, drive, sign * drive.dry_torque) > 0.0


@compiled
def half_period(drive: ArmatureDrive) -> float:
    """Return the time in which the speed can have one extremum at most [s]; endless without oscillation."""
    squared = angular_frequency_squared(drive)
    return math.pi / math.sqrt(squared) if squared > 0.0 else math.inf


@compiled
def angular_frequency_squared(drive: ArmatureDrive) -> float:
    """Return the square of the angular frequency of current and speed [1/s2]; not above 0 where they do not swing."""
    half = 0.5 * (drive.resistance / drive.inductance - drive.damping / drive.inertia)
    return drive.constant * drive.constant / (drive.inductance * drive.inertia) - half * half


@compiled
def within_half_period(stretch: float, drive: ArmatureDrive) -> float:
    """Return the stretch [s], at most the half period; its root and quotient are taken only where it may be shorter."""
    if not angular_frequency_squared(drive) * stretch * stretch > CERTAINLY_SHORTER:
        return stretch
    return min(stretch, half_period(drive))


@compiled
def instant_below_zero(motion: ArmatureMotion, drive: ArmatureDrive, sign: float, stretch: float) -> float:
    """Return an instant at which a speed that dips within the stretch has changed its sign; 0 if it never does.

    Bisection of the acceleration, which changes its sign once; start: the ends of the stretch; tolerance and cap:
    `SEARCH_TOLERANCE`, `SEARCH_CAP`.
    """
    low, high = 0.0, stretch
    for _ in range(SEARCH_CAP):
        middle = 0.5 * (low + high)
        point = glide(motion, drive, sign * drive.dry_torque, middle)
        if sign * point.speed < 0.0:
            return middle
        if sign * acceleration(point, drive, sign * drive.dry_torque) < 0.0:
            low = middle
        else:
            high = middle
        if high - low <= SEARCH_TOLERANCE * stretch:
            break
    return 0.0


@compiled
def instant_of_zero(motion: ArmatureMotion, drive: ArmatureDrive, sign: float, below: float) -> float:
    """Return the instant in (0, below] at which the speed comes to zero; at `below` its sign has changed.

    Newton's method kept inside a shrinking bracket, else halving it. Start: the middle; tolerance:
    `SEARCH_TOLERANCE` of `below`; cap: `SEARCH_CAP`; at the cap the middle of the bracket is the answer. Takes
    four to six evaluations as a rule.
    """
    torque = sign * drive.dry_torque
    low, high = 0.0, below
    instant = 0.5 * below
    for _ in range(SEARCH_CAP):
        point = glide(motion, drive, torque, instant)
        if sign * point.speed > 0.0:
            low = instant
        else:
            high = instant
        slope = acceleration(point, drive, torque)
        following = instant - point.speed / slope if slope != 0.0 else -1.0  # 0: it keeps its speed
        if not low <= following <= high:
            following = 0.5 * (low + high)
        if abs(following - instant) <= SEARCH_TOLERANCE * below:
            return following
        instant = following
    return instant
