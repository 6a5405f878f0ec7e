"""The whole wiper neither gains energy from friction or worm, nor loses any where nothing takes it."""

import math

from hypothesis import given, settings
from hypothesis import strategies as st
from support.closed_form import ClosedFormWiper

from hilplant.models.armature import ArmatureMotion
from hilplant.models.circuit import Connection, seen_by_armature
from hilplant.models.load import resist
from hilplant.models.lookup import find
from hilplant.models.records import Arm, Blade, Brush, Friction, Load, Motor, Parameters, ParkSwitch
from hilplant.models.resistance import Crank
from hilplant.models.shaft import Joint, Train, start_of, turn
from hilplant.models.terminals import Shaft
from hilplant.models.torque_network import NO_TANGENT
from hilplant.models.wiring import GROUND, NOTHING, SUPPLY, Leads
from hilplant.signals import Inputs

WIPER = ClosedFormWiper()
TABLES = WIPER.tables(4096)
SLOW, FAST = Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2)
RATIO, STEP_S = 63.0, 1e-3
LARGEST_POTENTIAL = WIPER.left.weight_n_m + WIPER.right.weight_n_m
#: What may be gained in one step, as a part of all energies that take part: the error of the method.
ROUNDING = 1e-5
FRICTION = Friction(
    0.3186, 0.1238, 1.996, 19.96, 0.4454, 4.454, 7.578e-3, 0.6756, 6.756, 2.795e-4, 3.456e-3, 2.4, 0.5, 0.6, 0.02
)
ANGLES, SPEEDS = st.floats(0.0, 2.0 * math.pi, exclude_max=True), st.floats(-300.0, 300.0) | st.floats(-2.0, 2.0)
FREE = Inputs(0.0, 0.0, 13.5, 0.0, 0.0, 0.0)
IDEAL = Motor(SLOW, FAST, 1.983e-5, 0.0, 0.0, RATIO, 1.0, 1.0)
OPEN = seen_by_armature(Leads(NOTHING, NOTHING, GROUND, NOTHING, 0.0), IDEAL, 0.0, 1.0, Shaft(0.0, 0.0))


def train_of(motor: Motor, load: Load, inputs: Inputs, connection: Connection, step_s: float = STEP_S) -> Train:
    parameters = Parameters(step_s, motor, ParkSwitch(0.0, 0.1, 0.0, 0.0), load, Arm(0.0, 0.7), Arm(0.0, 0.5))
    return Train(connection, TABLES, inputs, parameters, 0.0, NO_TANGENT)


def turned(motion: ArmatureMotion, angle: float, train: Train) -> ArmatureMotion:
    crank = Crank(TABLES, find(TABLES, angle), angle, motion.speed / RATIO)
    load = resist(crank, train.parameters, train.inputs)
    return turn(Joint(motion, start_of(motion, load, train), angle, train.parameters.step_s), load, train)


def energy(angle: float, motion: ArmatureMotion, motor: Motor) -> float:
    stored = 0.5 * motor.inertia_kg_m2 * motion.speed**2 + 0.5 * SLOW.inductance_henry * motion.current**2
    return stored + WIPER.energy(angle, motion.speed / RATIO)


@settings(max_examples=200, deadline=None)
@given(angle=ANGLES, speed=st.floats(80.0, 300.0), way=st.sampled_from([-1.0, 1.0]))
def test_without_friction_an_ideal_gear_keeps_the_energy(angle: float, speed: float, way: float) -> None:
    motor = IDEAL
    train = train_of(motor, Load(2.0), FREE, OPEN)
    motion, place, before = (
        ArmatureMotion(0.0, way * speed, 0.0),
        angle,
        energy(angle, ArmatureMotion(0.0, speed, 0.0), motor),
    )
    for _ in range(100):
        motion = turned(ArmatureMotion(0.0, motion.speed, 0.0), place % (2.0 * math.pi), train)
        place += motion.turned / RATIO
    assert abs(energy(place, motion, motor) - before) < 1e-5 * (before + 2.0 * LARGEST_POTENTIAL)


@settings(max_examples=300, deadline=None)
@given(
    angle=ANGLES,
    speed=SPEEDS,
    current=st.floats(-10.0, 10.0),
    volts=st.floats(-16.0, 16.0),
    surroundings=st.tuples(st.floats(0.0, 1.0), st.just(0.0) | st.floats(0.0, 60.0), st.sampled_from([0.0, 0.3])),
)
def test_no_step_gains_more_energy_than_the_terminals_put_in(
    angle: float, speed: float, current: float, volts: float, surroundings: tuple[float, float, float]
) -> None:
    screen, brake, back = surroundings
    motor = Motor(SLOW, FAST, 1.983e-5, 1.582e-4, 0.02, RATIO, 0.8, back)
    load = Load(2.0, friction=FRICTION, left_blade=Blade(7.615), right_blade=Blade(7.615))
    leads = Leads(SUPPLY, NOTHING, GROUND, NOTHING, 0.0)
    connection = seen_by_armature(leads, motor, volts, 1.0, Shaft(current, speed))
    train = train_of(motor, load, FREE._replace(screen=screen, brake_torque_n_m=brake), connection)
    start = ArmatureMotion(current, speed, 0.0)
    end = turned(start, angle, train)
    # the motor alone, which a self-locking worm must not drive; then motor and wiper together
    own_start = 0.5 * motor.inertia_kg_m2 * speed**2 + 0.5 * SLOW.inductance_henry * current**2
    own_end = 0.5 * motor.inertia_kg_m2 * end.speed**2 + 0.5 * SLOW.inductance_henry * end.current**2
    flux = SLOW.inductance_henry * (end.current - current) + SLOW.constant_v_s * end.turned
    charge = (volts * STEP_S - flux) / SLOW.resistance_ohm
    heat = SLOW.resistance_ohm * charge**2 / STEP_S + motor.coulomb_torque_n_m * abs(end.turned)
    gain = own_end - own_start - (volts * charge - heat)
    size = own_start + own_end + abs(volts * charge) + heat + WIPER.energy(angle, speed / RATIO) + LARGEST_POTENTIAL
    if back == 0.0:
        assert gain <= ROUNDING * size
    wiper = WIPER.energy(angle + end.turned / RATIO, end.speed / RATIO) - WIPER.energy(angle, speed / RATIO)
    assert gain + wiper <= ROUNDING * size


@settings(max_examples=60, deadline=None)
@given(angle=ANGLES, speed=SPEEDS)
def test_an_open_armature_has_no_current_and_coasts_to_rest(angle: float, speed: float) -> None:
    motor = Motor(SLOW, FAST, 1.983e-5, 1.582e-4, 0.02, RATIO)
    load = Load(2.0, friction=FRICTION, left_blade=Blade(7.615), right_blade=Blade(7.615))
    train, place = train_of(motor, load, FREE, OPEN), angle
    motion = ArmatureMotion(0.0, speed, 0.0)
    for _ in range(600):
        after = turned(ArmatureMotion(0.0, motion.speed, 0.0), place % (2.0 * math.pi), train)
        assert after.current == 0.0
        assert abs(after.speed) <= abs(motion.speed)
        place, motion = place + after.turned / RATIO, after
    assert motion.speed == 0.0
