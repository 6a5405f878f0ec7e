"""The torque that a wiper asks of its crank over a turn at even speed, from the load model of the step itself."""

from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench
from hilplant.models.load import resist
from hilplant.models.lookup import find
from hilplant.models.resistance import Crank
from hilplant.models.row import unpack
from hilplant.signals import SCREENS, Inputs

WETNESS = dict(SCREENS)


@dataclass(frozen=True, slots=True)
class Conditions:
    """What a turn meets: the wetness of the screen from 0 to 1, and the speed of the vehicle [m/s].

    `pressed` is a factor on the force of both arms; 0 lifts them, and leaves everything but friction.
    """

    wetness: float
    vehicle_speed_m_s: float = 0.0
    pressed: float = 1.0


def crank_torque(bench: Bench, crank_rad: Floats, crank_speed_rad_s: float, conditions: Conditions) -> Floats:
    """Return the torque at the crank [N m] at each angle, positive when it opposes positive speed.

    The speed is constant, so the inertia shows only where it changes with the angle, M'(angle) w^2/2.
    """
    given: Inputs = unpack(Inputs, bench.input_row)
    inputs = given._replace(
        screen=conditions.wetness,
        vehicle_speed_m_s=conditions.vehicle_speed_m_s,
        left_force=given.left_force * conditions.pressed,
        right_force=given.right_force * conditions.pressed,
    )
    return np.array([_torque(bench, angle, crank_speed_rad_s, inputs) for angle in crank_rad])


def _torque(bench: Bench, crank_angle_rad: float, crank_speed_rad_s: float, inputs: Inputs) -> float:
    crank = Crank(bench.tables, find(bench.tables, crank_angle_rad), crank_angle_rad, crank_speed_rad_s)
    found = resist(crank, bench.parameters, inputs)
    direction = 1.0 if crank_speed_rad_s > 0.0 else -1.0
    return float(found.bias + direction * (found.dry + found.slope * abs(crank_speed_rad_s)))
