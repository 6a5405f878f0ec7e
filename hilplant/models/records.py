"""What the step reads and returns, and the flat rows by which these records enter compiled code.

A call into compiled code takes ten times as long with a record as with an array, so the loop passes arrays and
:func:`unpack_parameters` and :func:`unpack_state` name their elements again on the inside.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hilplant.jit import compiled, compiled_with_arrays


class Brush(NamedTuple):
    """Armature circuit seen from one brush, (3.30), (3.31)."""

    resistance_ohm: float
    inductance_henry: float
    constant_v_s: float  # back-EMF constant [V s/rad], equal to the torque constant [N m/A]


class Motor(NamedTuple):
    """Two-speed permanent-magnet motor with its worm gear: nine parameters, the ratio and two efficiencies.

    `gear_efficiency` holds while the motor drives the load, in (0, 1]. `gear_back_efficiency` is the part of the
    load's torque that reaches the motor when the load drives: 0 for a self-locking worm.
    """

    slow: Brush
    fast: Brush
    inertia_kg_m2: float
    damping_n_m_s: float
    coulomb_torque_n_m: float
    gear_ratio: float
    gear_efficiency: float = 1.0
    gear_back_efficiency: float = 0.0


class ParkSwitch(NamedTuple):
    """Contact over the crank angle, and the circuit it is part of; see :mod:`hilplant.models.circuit`.

    The window lies symmetrically about the park angle. `circuit` is the place in ``circuit.CIRCUITS``;
    `reverse_angle_rad` is how far the depressed circuit turns the crank back.
    """

    angle_rad: float
    half_window_rad: float
    hysteresis_rad: float
    bounce_ticks: float
    circuit: float = 0.0
    reverse_angle_rad: float = 0.0


class Friction(NamedTuple):
    """Coefficients of (4.49) and (4.50) for velocities in mm/s, and of the tacky screen between the two.

    Beyond `velocity_limit_mm_s` a coefficient keeps the value that it has there.
    """

    dry_1: float = 0.0
    dry_2: float = 0.0
    dry_3: float = 0.0
    dry_4: float = 0.0
    wet_1: float = 0.0
    wet_2: float = 0.0
    wet_3: float = 0.0
    wet_4: float = 0.0
    wet_5: float = 0.0
    wet_6: float = 0.0
    wet_7: float = 0.0
    tacky_1: float = 0.0
    tacky_2: float = 0.0
    tacky_3: float = 0.0
    tacky_4: float = 0.0
    velocity_limit_mm_s: float = 1000.0


class Blade(NamedTuple):
    """One blade: the force [N] with which its arm presses it on the screen, and a factor on its friction."""

    force_n: float = 0.0
    wear: float = 1.0


class Load(NamedTuple):
    """Which load the crank carries, and its coefficients; see :mod:`hilplant.models.load`.

    `points` is the number of points of each blade at which friction acts, with equal shares of the force.
    """

    model: float
    c1: float = 0.0
    c2: float = 0.0
    points: float = 1.0
    friction: Friction = Friction()
    left_blade: Blade = Blade()
    right_blade: Blade = Blade()


class Arm(NamedTuple):
    """One arm on its rocker: the angle between them, and the distance from its pivot to the blade."""

    offset_rad: float
    length_m: float


#: What stands behind the parameters of a plant without networks.
NO_NETWORKS = np.zeros(0)


class Parameters(NamedTuple):
    """Everything that stays as it is while the plant runs, except the tables over the crank angle.

    `motor_model` is the place in ``shaft.MOTORS``. `networks` holds the numbers of all networks in one row: how many
    the torque network has, these, then those of the motor network; it is empty where there are none.
    """

    step_s: float
    motor: Motor
    park_switch: ParkSwitch
    load: Load
    left_arm: Arm
    right_arm: Arm
    motor_model: float = 0.0
    networks: Any = NO_NETWORKS


class State(NamedTuple):
    """Everything that the plant remembers from one tick to the next."""

    current_a: float
    motor_speed_rad_s: float
    crank_angle_rad: float
    park_contact: float  # after bouncing: 1 while the cam holds the contact closed
    bounce_left: float  # ticks for which the contact still bounces
    guard: float
    park_phase: float = 0.0  # of the depressed park circuit: 0 wiping, 1 turning back, 2 parked
    # what the motor network remembers of the tick before: its inputs, and its outputs at the start of that tick
    last_terminal_v: float = 0.0
    last_torque_n_m: float = 0.0
    last_current_a: float = 0.0
    last_speed_rad_s: float = 0.0
    last_brush: float = 0.0  # whose these four are: 1 slow, 2 fast, 0 nothing that the network could go on from
    motor_mode: float = 0.0  # who moved the motor, the place in models/narx.py MODES
    load_mode: float = 0.0  # who gave the torque, the place in signals.IN_CHARGE


class Inputs(NamedTuple):
    """Inputs of one tick, in the order of ``signals.INPUTS``."""

    relay_on: float
    relay_fast: float
    supply_v: float
    screen: float
    vehicle_speed_m_s: float
    brake_torque_n_m: float
    left_screen: float = -1.0
    right_screen: float = -1.0
    left_wear: float = 1.0
    right_wear: float = 1.0
    left_force: float = 1.0
    right_force: float = 1.0


class Outputs(NamedTuple):
    """Outputs of one tick, in the order of ``signals.OUTPUTS``."""

    supply_v: float
    terminal_v: float
    current_a: float
    motor_speed_rad_s: float
    crank_speed_rad_s: float
    crank_angle_rad: float
    load_torque_n_m: float
    park_contact: float
    left_arm_rad: float
    right_arm_rad: float
    left_rocker_rad: float
    right_rocker_rad: float
    left_blade_m_s: float
    right_blade_m_s: float
    relay_on: float
    relay_fast: float
    guard: float
    terminal_53_v: float
    terminal_53b_v: float
    terminal_53e_v: float
    terminal_31_v: float
    left_force_n: float
    right_force_n: float
    load_mode: float
    motor_mode: float


def pack(record: tuple[Any, ...]) -> NDArray[np.float64]:
    """Flatten a record, nested ones and arrays in place, into a row of floats."""
    values: list[float] = []
    for field in record:
        values.extend(pack(field) if isinstance(field, tuple) else np.atleast_1d(field).astype(float))
    return np.array(values, dtype=np.float64)


#: Length of a packed row of parameters without networks, and where in it the load's model and number of points are.
PARAMETER_COUNT = 48
MODEL_AT = 19
POINTS_AT = 22


@compiled_with_arrays
def unpack_parameters(row: Any) -> Parameters:
    """Give the elements of a packed row their names back; the inverse of :func:`pack`."""
    slow = Brush(row[1], row[2], row[3])
    fast = Brush(row[4], row[5], row[6])
    motor = Motor(slow, fast, row[7], row[8], row[9], row[10], row[11], row[12])
    park_switch = ParkSwitch(row[13], row[14], row[15], row[16], row[17], row[18])
    left_arm, right_arm = Arm(row[43], row[44]), Arm(row[45], row[46])
    networks = row[PARAMETER_COUNT:]
    return Parameters(row[0], motor, park_switch, unpack_load(row), left_arm, right_arm, row[47], networks)


@compiled
def unpack_load(row: Any) -> Load:
    """Name the elements of the load within a packed row of parameters."""
    friction = Friction(
        row[23], row[24], row[25], row[26],
        row[27], row[28], row[29], row[30], row[31], row[32], row[33],
        row[34], row[35], row[36], row[37], row[38],
    )  # fmt: skip
    left, right = Blade(row[39], row[40]), Blade(row[41], row[42])
    return Load(row[19], row[20], row[21], row[22], friction, left, right)


@compiled
def unpack_state(row: Any) -> State:
    """Name the elements of a packed state."""
    return State(
        row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9], row[10], row[11],
        row[12], row[13],
    )  # fmt: skip


@compiled
def unpack_inputs(row: Any) -> Inputs:
    """Name the elements of a row of inputs."""
    return Inputs(row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9], row[10], row[11])
