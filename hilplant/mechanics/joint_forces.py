"""How much each joint of a wiper carries over a turn, for the sizing of bearings and rods."""

from dataclasses import dataclass

import numpy as np

from hilplant.mechanics.inverse_dynamics import AppliedForce, CrankMotion, Loads, inverse_dynamics
from hilplant.mechanics.motion import Motion, motion, point_motion
from hilplant.mechanics.planar import Pin
from hilplant.mechanics.wiper import Wiper
from hilplant.units import RAD_PER_DEG, TURN_RAD

#: Crank angles at which the turn is looked at.
ANGLES = 3600


@dataclass(frozen=True, slots=True)
class PeakLoad:
    """Largest force in a joint [N], the crank angle where it occurs [deg], and the largest moment [N m]."""

    joint: str
    force_n: float
    crank_deg: float
    moment_n_m: float


def loads_over_a_turn(wiper: Wiper, crank_speed_rad_s: float, blade_force_n: float) -> tuple[Motion, Loads]:
    """Return the loads of a turn at even speed against a constant friction force [N] on each blade.

    The force is shared evenly by the blade's friction points and acts against their motion.
    """
    moving = motion(wiper, np.linspace(0.0, TURN_RAD, ANGLES, endpoint=False))
    applied = [
        _against(wiper, moving, pin, blade_force_n / len(side.friction) * np.sign(crank_speed_rad_s))
        for side in wiper.sides
        for pin in side.friction
    ]
    return moving, inverse_dynamics(wiper, moving, CrankMotion(crank_speed_rad_s, 0.0), applied)


def _against(wiper: Wiper, moving: Motion, pin: Pin, force_n: float) -> AppliedForce:
    way = point_motion(wiper, moving, pin).rate
    return AppliedForce(pin, -force_n * way / np.linalg.norm(way, axis=1, keepdims=True))


def peak_loads(wiper: Wiper, crank_speed_rad_s: float, blade_force_n: float) -> list[PeakLoad]:
    """Return what each joint carries at most, in the order of the mechanism's joints."""
    moving, loads = loads_over_a_turn(wiper, crank_speed_rad_s, blade_force_n)
    peaks = []
    for joint in loads.joints:
        sizes = np.linalg.norm(joint.force_n, axis=1)
        worst = int(sizes.argmax())
        at_deg = float(moving.crank_rad[worst] / RAD_PER_DEG)
        name = f"{joint.first} - {joint.second}"
        peaks.append(PeakLoad(name, float(sizes[worst]), at_deg, float(np.abs(joint.moment_n_m).max())))
    return peaks
