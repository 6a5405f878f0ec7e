"""What a velocity controller reads, remembers and commands: records of floats, so that one loop is compiled code."""

from typing import NamedTuple

#: Names of the control laws; ``Controller.law`` is the place in this list.
LAWS = ("pid", "neuron", "cascade")

#: Names of the learning rules of section 7.3; ``Neuron.rule`` is the place in this list.
RULES = ("hebb", "error_hebb", "quadratic")

#: Where a controller takes the speed from; ``Controller.source`` is the place in this list.
SOURCES = ("sensor", "network", "observer")


class Measured(NamedTuple):
    """What a controller sees in one tick: speed of the crank [rad/s], armature current [A], park contact 0 or 1."""

    speed_rad_s: float
    current_a: float
    park_contact: float


class Command(NamedTuple):
    """What a controller asks for: the supply voltage [V], and the fast brush (1) or the slow one (0)."""

    voltage_v: float
    fast: float


class Pid(NamedTuple):
    """Gains of (7.1) for an error in rad/s of the crank: [V s/rad], [V/rad], [V s2/rad].

    `weight` is the part of the reference that the proportional term sees: 1 as in (7.1), less to start more gently.
    """

    proportional: float = 0.0
    integral: float = 0.0
    derivative: float = 0.0
    weight: float = 1.0


class Neuron(NamedTuple):
    """A single-neuron PID, (7.4)-(7.10), Table 7-4.

    `gain` is K of (7.6); with `fuzzy` it is the factor on what the fuzzy system gives. `rate_*` are the learning
    rates, `start_*` the weights at power-on, both for the integral (1), proportional (2) and derivative (3) input.
    """

    rule: float = 0.0
    gain: float = 0.0
    fuzzy: float = 0.0
    rate_integral: float = 1.0
    rate_proportional: float = 1.5
    rate_derivative: float = 1.0
    start_integral: float = 1.0
    start_proportional: float = 0.0
    start_derivative: float = 0.0
    error_weight: float = 2.0  # P of (7.10)
    output_weight: float = 1.0  # Q of (7.10)
    first_output: float = 1.0  # b0 of (7.10)


class BelievedArmature(NamedTuple):
    """The motor as a controller believes it to be, with one brush; all SI, all at the motor shaft."""

    resistance_ohm: float = 1.0
    inductance_henry: float = 1.0
    constant_v_s: float = 1.0
    inertia_kg_m2: float = 1.0  # with what of the load it takes for granted
    damping_n_m_s: float = 0.0
    gear_ratio: float = 1.0


class Observer(NamedTuple):
    """One brush's motor in discrete time, and a constant gain: x(k+1) = A x + B V + gain (y - x(k)).

    x is current [A], motor speed [rad/s] and load torque at the motor shaft [N m], the last one held. `speed_*` are
    gains on the error in the measured speed; 0 without a sensor.
    """

    a11: float = 1.0
    a12: float = 0.0
    a13: float = 0.0
    a21: float = 0.0
    a22: float = 1.0
    a23: float = 0.0
    b1: float = 0.0
    b2: float = 0.0
    current_1: float = 0.0
    current_2: float = 0.0
    current_3: float = 0.0
    speed_1: float = 0.0
    speed_2: float = 0.0
    speed_3: float = 0.0


class Model(NamedTuple):
    """What a controller knows of one brush."""

    armature: BelievedArmature = BelievedArmature()
    observer: Observer = Observer()  # with a speed sensor if the controller has one


class Cascade(NamedTuple):
    """Bandwidths [1/s]: of the speed towards its reference, and of the current towards what the speed asks for."""

    speed_rate: float = 0.0
    current_rate: float = 0.0


class Stages(NamedTuple):
    """The chart of section 7.6: above `up_v` for `hold_s` on to the fast brush, below `down_v` for a turn back to slow.

    `factor` is applied to the voltage on the way up, its inverse on the way down, so that the back-EMF is met.
    """

    up_v: float = 1e9
    down_v: float = 0.0
    hold_s: float = 0.2
    factor: float = 1.0


class Controller(NamedTuple):
    """One velocity controller with all that it needs, fixed before the first tick."""

    law: float
    period_s: float
    pid: Pid = Pid()
    neuron: Neuron = Neuron()
    cascade: Cascade = Cascade()
    stages: Stages = Stages()
    slow: Model = Model()
    fast: Model = Model()
    lowest_v: float = 0.0
    highest_v: float = 20.0
    source: float = 0.0
    adapting: float = 0.0  # gain of the resistance's correction at each passage of the park switch, 0 to 1


class SpeedEstimate(NamedTuple):
    """What an observer believes, and what it needs to correct the resistance once a turn."""

    current_a: float = 0.0
    motor_speed_rad_s: float = 0.0
    torque_n_m: float = 0.0
    resistance_factor: float = 1.0  # the believed resistance over the model's
    turned_rad: float = -1.0  # crank angle since the park contact closed; below 0 before the first time
    charge_a_s: float = 0.0
    contact: float = 1.0


class PidMemory(NamedTuple):
    """The integral part of the voltage [V], and the error of the last tick [rad/s]."""

    integral_v: float = 0.0
    error: float = 0.0


class NeuronMemory(NamedTuple):
    """Errors of the last two ticks [rad/s], the weights (all 0 before the first tick), and K in force."""

    error: float = 0.0
    error_before: float = 0.0
    integral: float = 0.0
    proportional: float = 0.0
    derivative: float = 0.0
    gain: float = 0.0


class Stage(NamedTuple):
    """The brush in use, 1 fast or 0 slow, and the share, 0 to 1, of the wait for the other one that has passed."""

    fast: float = 0.0
    waited: float = 0.0


class Memory(NamedTuple):
    """Everything that a controller remembers from one tick to the next; the defaults are those at power-on."""

    voltage_v: float = 0.0
    stage: Stage = Stage()
    pid: PidMemory = PidMemory()
    neuron: NeuronMemory = NeuronMemory()
    estimate: SpeedEstimate = SpeedEstimate()


#: What every controller remembers before its first tick.
POWER_ON = Memory()

#: What an observer believes before its first tick.
AT_REST = SpeedEstimate()
