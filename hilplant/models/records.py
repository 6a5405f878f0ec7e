"""What the step reads and returns, and the flat rows by which these records enter compiled code.

A call into compiled code takes ten times as long with a record as with an array, so the loop passes arrays and
:func:`unpack_parameters` and :func:`unpack_state` name their elements again on the inside.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hilplant.jit import compiled


class Brush(NamedTuple):
    """Armature circuit seen from one brush, (3.30), (3.31)."""

    resistance_ohm: float
    inductance_henry: float
    constant_v_s: float  # back-EMF constant [V s/rad], equal to the torque constant [N m/A]


class Motor(NamedTuple):
    """Two-speed permanent-magnet motor with its worm gear: nine parameters and the ratio."""

    slow: Brush
    fast: Brush
    inertia_kg_m2: float
    damping_n_m_s: float
    coulomb_torque_n_m: float
    gear_ratio: float


class ParkSwitch(NamedTuple):
    """Contact over the crank angle; the window lies symmetrically about the park angle."""

    angle_rad: float
    half_window_rad: float
    hysteresis_rad: float
    bounce_ticks: float


class Load(NamedTuple):
    """Which load the crank carries, and its coefficients; see :mod:`hilplant.models.load`."""

    model: float
    c1: float
    c2: float


class Arm(NamedTuple):
    """One arm on its rocker: the angle between them, and the distance from its pivot to the blade."""

    offset_rad: float
    length_m: float


class Parameters(NamedTuple):
    """Everything that stays as it is while the plant runs, except the tables over the crank angle."""

    step_s: float
    motor: Motor
    park_switch: ParkSwitch
    load: Load
    left_arm: Arm
    right_arm: Arm


class State(NamedTuple):
    """Everything that the plant remembers from one tick to the next."""

    current_a: float
    motor_speed_rad_s: float
    crank_angle_rad: float
    park_contact: float  # after bouncing: 1 while the cam holds the contact closed
    bounce_left: float  # ticks for which the contact still bounces
    guard: float


class Inputs(NamedTuple):
    """Inputs of one tick, in the order of ``signals.INPUTS``."""

    relay_on: float
    relay_fast: float
    supply_v: float
    screen: float
    vehicle_speed_m_s: float
    brake_torque_n_m: float


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


def pack(record: tuple[Any, ...]) -> NDArray[np.float64]:
    """Flatten a record, nested ones in place, into a row of floats."""
    values: list[float] = []
    for field in record:
        values.extend(pack(field) if isinstance(field, tuple) else [float(field)])
    return np.array(values, dtype=np.float64)


@compiled
def unpack_parameters(row: Any) -> Parameters:
    """Give the elements of a packed row their names back; the inverse of :func:`pack`."""
    slow = Brush(row[1], row[2], row[3])
    fast = Brush(row[4], row[5], row[6])
    motor = Motor(slow, fast, row[7], row[8], row[9], row[10])
    park_switch = ParkSwitch(row[11], row[12], row[13], row[14])
    load = Load(row[15], row[16], row[17])
    return Parameters(row[0], motor, park_switch, load, Arm(row[18], row[19]), Arm(row[20], row[21]))


@compiled
def unpack_state(row: Any) -> State:
    """Name the elements of a packed state."""
    return State(row[0], row[1], row[2], row[3], row[4], row[5])


@compiled
def unpack_inputs(row: Any) -> Inputs:
    """Name the elements of a row of inputs."""
    return Inputs(row[0], row[1], row[2], row[3], row[4], row[5])
