"""What the step remembers and what it is given for good; each element is declared where it stands."""

from typing import Annotated, Any, NamedTuple

import numpy as np

from hilplant.declaration import choice, declared, flag, index_of, quantity
from hilplant.models.mechanical_records import IceState, LinkageCondition, LinkageState, Obstacles, PlayState
from hilplant.models.slow_records import Heat, HeatState, Water, WaterState, Wear, WearState
from hilplant.signals import ACTIVE_MODELS


class Brush(NamedTuple):
    """Armature circuit seen from one brush, (3.30), (3.31)."""

    resistance_ohm: Annotated[float, quantity("Ohm", "resistance of the armature circuit")]
    inductance_henry: Annotated[float, quantity("H", "inductance of the armature circuit")]
    constant_v_s: Annotated[float, quantity("V s/rad", "back-EMF constant, equal to the torque constant [N m/A]")]


class Motor(NamedTuple):
    """Two-speed permanent-magnet motor with its worm gear: nine parameters, the ratio and two efficiencies."""

    slow: Brush
    fast: Brush
    inertia_kg_m2: Annotated[float, quantity("kg m2", "inertia of the motor shaft")]
    damping_n_m_s: Annotated[float, quantity("N m s/rad", "viscous friction of the motor shaft")]
    coulomb_torque_n_m: Annotated[float, quantity("N m", "dry friction of the motor shaft")]
    gear_ratio: Annotated[float, quantity("", "turns of the motor shaft for one of the crank")]
    gear_efficiency: Annotated[float, quantity("", "efficiency while the motor drives the load, in (0, 1]")] = 1.0
    gear_back_efficiency: Annotated[
        float, quantity("", "part of the load's torque that reaches the motor when the load drives; 0: self-locking")
    ] = 0.0


class ParkSwitch(NamedTuple):
    """Contact over the crank angle, and the circuit it is part of; see :mod:`hilplant.models.circuit`.

    The window lies symmetrically about the park angle.
    """

    angle_rad: Annotated[float, quantity("rad", "crank angle in the middle of the window")]
    half_window_rad: Annotated[float, quantity("rad", "half the width of the window in which the contact closes")]
    hysteresis_rad: Annotated[float, quantity("rad", "how far beyond the window it stays closed")]
    bounce_ticks: Annotated[float, quantity("ticks", "how long the contact bounces after an edge")]
    circuit: Annotated[float, quantity("", "index in wiring.CIRCUITS")] = 0.0
    reverse_angle_rad: Annotated[float, quantity("rad", "how far the depressed circuit turns the crank back")] = 0.0


class Friction(NamedTuple):
    """Coefficients of (4.49) and (4.50) for velocities in mm/s, and of the tacky screen between the two.

    Beyond `velocity_limit_mm_s` a coefficient keeps the value that it has there.
    """

    dry_1: Annotated[float, quantity("", "dry screen: share of the first tanh, (4.49)")] = 0.0
    dry_2: Annotated[float, quantity("s/mm", "dry screen: rate of the first tanh, (4.49)")] = 0.0
    dry_3: Annotated[float, quantity("", "dry screen: share of the second tanh, (4.49)")] = 0.0
    dry_4: Annotated[float, quantity("s/mm", "dry screen: rate of the second tanh, (4.49)")] = 0.0
    wet_1: Annotated[float, quantity("", "wet screen: c1 of (4.50)")] = 0.0
    wet_2: Annotated[float, quantity("s/mm", "wet screen: c2 of (4.50)")] = 0.0
    wet_3: Annotated[float, quantity("s/mm", "wet screen: c3 of (4.50)")] = 0.0
    wet_4: Annotated[float, quantity("", "wet screen: c4 of (4.50)")] = 0.0
    wet_5: Annotated[float, quantity("s/mm", "wet screen: c5 of (4.50)")] = 0.0
    wet_6: Annotated[float, quantity("s/mm", "wet screen: c6 of (4.50)")] = 0.0
    wet_7: Annotated[float, quantity("1/N", "wet screen: c7 of (4.50), change by the force of the blade")] = 0.0
    tacky_1: Annotated[float, quantity("", "tacky screen: share of the first tanh")] = 0.0
    tacky_2: Annotated[float, quantity("s/mm", "tacky screen: rate of the first tanh")] = 0.0
    tacky_3: Annotated[float, quantity("", "tacky screen: share of the Stribeck term")] = 0.0
    tacky_4: Annotated[float, quantity("s/mm", "tacky screen: rate of the Stribeck term")] = 0.0
    velocity_limit_mm_s: Annotated[float, quantity("mm/s", "velocity beyond which a coefficient stays")] = 1000.0


class Blade(NamedTuple):
    """One blade on its screen."""

    force_n: Annotated[float, quantity("N", "force with which the arm presses the blade on the screen")] = 0.0
    wear: Annotated[float, quantity("", "factor on the blade's friction")] = 1.0


class Load(NamedTuple):
    """Which load the crank carries, and its coefficients; see :mod:`hilplant.models.load`."""

    model: Annotated[float, quantity("", "index in load.LOADS")]
    c1: Annotated[float, quantity("", "first coefficient of a load without tables; c1 of (6.3) [s/rad]")] = 0.0
    c2: Annotated[float, quantity("", "second coefficient of a load without tables; c2 of (6.3) [N m s/rad]")] = 0.0
    points: Annotated[
        float, quantity("", "points of each blade at which friction acts, with equal shares of the force")
    ] = 1.0
    friction: Friction = Friction()
    left_blade: Blade = Blade()
    right_blade: Blade = Blade()


class Arm(NamedTuple):
    """One arm on its rocker."""

    offset_rad: Annotated[float, quantity("rad", "angle from the rocker to the arm")]
    length_m: Annotated[float, quantity("m", "distance from the pivot to the blade")]


class Wire(NamedTuple):
    """The wire of one motor terminal, and what touches it at the motor's end."""

    resistance_ohm: Annotated[float, quantity("Ohm", "resistance in series")] = 0.0
    opened: Annotated[float, flag("1 where the wire is broken")] = 0.0
    to_supply_s: Annotated[float, quantity("S", "conductance from the terminal to the supply, terminal 30")] = 0.0
    to_ground_s: Annotated[float, quantity("S", "conductance from the terminal to ground, terminal 31")] = 0.0


class Wiring(NamedTuple):
    """Supply and wires between the switches and the motor; see :mod:`hilplant.models.terminals`."""

    altered: Annotated[float, flag("1 where any of the others is not as declared here")] = 0.0
    supply_resistance_ohm: Annotated[float, quantity("Ohm", "resistance of battery and harness")] = 0.0
    supply_opened: Annotated[float, flag("1 where the supply is cut off: a blown fuse, main switch off")] = 0.0
    ground_offset_v: Annotated[float, quantity("V", "potential of the motor's ground against the ECU's")] = 0.0
    brushes_s: Annotated[float, quantity("S", "conductance between the terminals 53 and 53b")] = 0.0
    wire_53: Wire = Wire()
    wire_53b: Wire = Wire()
    wire_53e: Wire = Wire()
    wire_31: Wire = Wire()


class RelayTiming(NamedTuple):
    """How a relay follows its command; times in ticks, rounded from seconds when a bench is built."""

    operate_ticks: Annotated[
        float, quantity("ticks", "from the command to the leaving of the contact, switching on")
    ] = 0.0
    release_ticks: Annotated[float, quantity("ticks", "the same, switching off")] = 0.0
    transfer_ticks: Annotated[float, quantity("ticks", "between the two contacts, touching neither")] = 0.0
    bounce_ticks: Annotated[float, quantity("ticks", "how long the contact bounces after it was made")] = 0.0
    stuck: Annotated[float, quantity("", "0 moves, 1 stuck where released, 2 stuck where operated")] = 0.0


class Relays(NamedTuple):
    """The two relays between the commands and the circuit; see :mod:`hilplant.models.relays`."""

    altered: Annotated[float, flag("1 where any of the others is not as declared here")] = 0.0
    on: RelayTiming = RelayTiming()
    fast: RelayTiming = RelayTiming()


class Sensors(NamedTuple):
    """What stands between the plant and what is measured of it; see :mod:`hilplant.models.sensors`."""

    altered: Annotated[float, flag("1 where any of the others is not as declared here")] = 0.0
    current_gain: Annotated[float, quantity("", "factor on the measured current")] = 1.0
    current_offset_a: Annotated[float, quantity("A", "added to the measured current")] = 0.0
    current_noise_a: Annotated[float, quantity("A", "standard deviation of the measured current's noise")] = 0.0
    current_limit_a: Annotated[float, quantity("A", "where the measured current saturates; 0: nowhere")] = 0.0
    park_stuck: Annotated[float, quantity("", "park contact: 0 moves, 1 stuck open, 2 stuck closed")] = 0.0
    current_ripple: Annotated[float, quantity("", "height of the commutator's ripple, as a part of the current")] = 0.0
    ripples_a_turn: Annotated[float, quantity("", "ripples of the current in a turn of the motor shaft")] = 0.0


#: What stands behind the parameters of a plant without networks.
NO_NETWORKS = np.zeros(0)


class Parameters(NamedTuple):
    """Everything that stays as it is while the plant runs, except the tables over the crank angle.

    `networks` holds the numbers of all networks in one row: how many the torque network has, these, then those of the
    motor network; it is empty where there are none.
    """

    step_s: Annotated[float, quantity("s", "length of a tick")]
    motor: Motor
    park_switch: ParkSwitch
    load: Load
    left_arm: Arm
    right_arm: Arm
    motor_model: Annotated[float, quantity("", "index in motor_choice.MOTORS")] = 0.0
    wiring: Wiring = Wiring()
    relays: Relays = Relays()
    sensors: Sensors = Sensors()
    heat: Heat = Heat()
    obstacles: Obstacles = Obstacles()
    linkage: LinkageCondition = LinkageCondition()
    wear: Wear = Wear()
    water: Water = Water()
    trained_load: Annotated[
        float, quantity("", "training.load_mark of the load for which a network was trained; 0: not looked at")
    ] = 0.0
    trained_motor: Annotated[float, quantity("", "the same of the motor")] = 0.0
    networks: Any = NO_NETWORKS


class Sample(NamedTuple):
    """What the motor network takes of one tick: voltage and torque during it, current and speed at its start."""

    terminal_v: Annotated[float, quantity("V", "voltage that drives the motor", watched=False, guarded=0.0)] = 0.0
    torque_n_m: Annotated[
        float, quantity("N m", "through the gear, at the crank, opposing positive speed", watched=False, guarded=0.0)
    ] = 0.0
    current_a: Annotated[float, quantity("A", "armature current", watched=False, guarded=0.0)] = 0.0
    speed_rad_s: Annotated[float, quantity("rad/s", "speed of the crank", watched=False, guarded=0.0)] = 0.0


class MotorMemory(NamedTuple):
    """What the motor network remembers of the tick before, and who moved the motor."""

    last: Sample = Sample()
    brush: Annotated[
        float, quantity("", "of `last`: 1 slow, 2 fast, 0 not within the training", watched=False, guarded=0.0)
    ] = 0.0
    mode: Annotated[float, choice(ACTIVE_MODELS, "who moved the motor", watched=False, guarded=0.0)] = 0.0


class RelayState(NamedTuple):
    """Where a relay's contact is, or comes from, where it goes, and the ticks until it rests there."""

    made: Annotated[float, flag("1 where it operates, 0 where it is released", watched=False)] = 0.0
    target: Annotated[float, flag("what was commanded last", watched=False)] = 0.0
    left: Annotated[float, quantity("ticks", "until it rests", watched=False)] = 0.0


class State(NamedTuple):
    """Everything that the plant remembers from one tick to the next."""

    current_a: Annotated[float, quantity("A", "armature current", guarded=0.0)] = 0.0
    motor_speed_rad_s: Annotated[float, quantity("rad/s", "speed of the motor shaft", guarded=0.0)] = 0.0
    crank_angle_rad: Annotated[float, quantity("rad", "crank angle from park, below one turn")] = 0.0
    park_contact: Annotated[float, flag("after bouncing: 1 while the cam holds the contact closed", watched=False)] = (
        0.0
    )
    bounce_left: Annotated[float, quantity("ticks", "how long the contact still bounces", watched=False)] = 0.0
    guard: Annotated[float, flag("1 once a number was not finite", watched=False, guarded=1.0)] = 0.0
    park_phase: Annotated[
        float, quantity("", "of the depressed park circuit: 0 wiping, 1 turning back, 2 parked", watched=False)
    ] = 0.0
    memory: MotorMemory = MotorMemory()
    load_mode: Annotated[
        float, choice(ACTIVE_MODELS, "who gave the torque of the load", watched=False, guarded=0.0)
    ] = 0.0
    relay_on: RelayState = RelayState()
    relay_fast: RelayState = RelayState()
    noise: Annotated[float, quantity("", "where the noise of the sensors has come to", watched=False)] = 1.0
    heat: HeatState = HeatState()
    ice: IceState = IceState()
    linkage: LinkageState = LinkageState()
    play: PlayState = PlayState()
    wear: WearState = WearState()
    water: WaterState = WaterState()


#: Where in its packed row each element is, by its name: `load.left_blade.wear` of the parameters, `memory.brush` of
#: the state. The numbers of the networks stand behind the parameters.
PARAMETER_INDEX = index_of(declared(Parameters))
STATE_INDEX = index_of(declared(State))
