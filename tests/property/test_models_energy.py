"""Friction, load and worm gear take energy out or do nothing, for any motor and any state."""

import math

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from hilplant.models.armature import ArmatureDrive, ArmatureMotion
from hilplant.models.motor import STRETCHES, advance, half_period


def powers_of_ten(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


STEP_S = 1e-3
MOTORS = st.builds(
    ArmatureDrive,
    voltage=st.floats(-20.0, 20.0),
    resistance=powers_of_ten(-1, 1),
    inductance=powers_of_ten(-5, -2),
    constant=powers_of_ten(-3.2, -0.5),
    inertia=powers_of_ten(-9, -4),
    damping=powers_of_ten(-5, 0),
    dry_torque=st.just(0.0) | powers_of_ten(-5, 1),
    push=st.just(0.0) | st.floats(-1.0, 1.0),
)
CURRENTS = st.just(0.0) | st.floats(-30.0, 30.0)
SPEEDS = st.just(0.0) | st.floats(-400.0, 400.0) | st.floats(-1.0, 1.0)


def stored(motion: ArmatureMotion, drive: ArmatureDrive) -> float:
    return 0.5 * drive.inductance * motion.current**2 + 0.5 * drive.inertia * motion.speed**2


@settings(max_examples=500, deadline=None)
@given(drive=MOTORS, current=CURRENTS, speed=SPEEDS)
def test_no_step_gains_more_energy_than_the_terminals_put_in(
    drive: ArmatureDrive, current: float, speed: float
) -> None:
    start = ArmatureMotion(current, speed, 0.0)
    end = advance(start, drive, STEP_S)
    assert math.isfinite(end.current + end.speed + end.turned)
    # the charge follows from the time integral of (3.30); the losses are at least those of a steady flow
    flux = drive.inductance * (end.current - current) + drive.constant * end.turned
    charge = (drive.voltage * STEP_S - flux) / drive.resistance
    losses = drive.resistance * charge**2 / STEP_S + drive.damping * end.turned**2 / STEP_S
    losses += drive.dry_torque * abs(end.turned)
    put_in = drive.voltage * charge + drive.push * end.turned
    size = stored(start, drive) + stored(end, drive) + abs(drive.voltage * charge) + losses
    size += abs(drive.push * end.turned)
    # the turned angle is a difference: good to 1e-15 rad, and to the bits of the final speed in the time constant
    strength = drive.resistance * drive.damping + drive.constant**2
    torque = drive.dry_torque + abs(drive.push)
    final_speed = (abs(drive.voltage) * drive.constant + drive.resistance * torque) / strength
    good_to = 1e-15 + 2.3e-16 * final_speed * drive.resistance * drive.inertia / strength
    rounding = 1e-9 * size + good_to * torque + 1e-18
    assert stored(end, drive) - stored(start, drive) <= put_in - losses + rounding


@settings(max_examples=300, deadline=None)
@given(drive=MOTORS, current=CURRENTS)
def test_a_shaft_at_rest_stays_while_the_motor_is_too_weak(drive: ArmatureDrive, current: float) -> None:
    strongest = drive.constant * max(abs(current), abs(drive.voltage) / drive.resistance) + abs(drive.push)
    end = advance(ArmatureMotion(current, 0.0, 0.0), drive._replace(dry_torque=strongest * 1.001 + 1e-9), STEP_S)
    assert (end.speed, end.turned) == (0.0, 0.0)


@settings(max_examples=300, deadline=None)
@given(drive=MOTORS, current=CURRENTS, speed=SPEEDS)
def test_one_step_is_the_same_as_two_halves(drive: ArmatureDrive, current: float, speed: float) -> None:
    assume(STEP_S / half_period(drive) < STRETCHES / 3)  # beyond, `advance` says, the cap may end the motion
    start = ArmatureMotion(current, speed, 0.0)
    whole = advance(start, drive, STEP_S)
    halves = advance(advance(start, drive, 0.5 * STEP_S), drive, 0.5 * STEP_S)
    # in units of energy: current and speed are compared as sqrt(L) i and sqrt(J) w
    size = math.sqrt(stored(start, drive) + stored(whole, drive) + abs(drive.voltage) ** 2 * 1e-6)
    assert abs(whole.current - halves.current) * math.sqrt(drive.inductance) <= 1e-6 * size + 1e-12
    assert abs(whole.speed - halves.speed) * math.sqrt(drive.inertia) <= 1e-6 * size + 1e-12
