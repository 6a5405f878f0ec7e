"""Crank torque and every joint's force for a given motion, by Lagrange multipliers.

For each body the equations of motion are M q'' + Cq^T lambda = Q, with the masses M, the Jacobian Cq of all constraints
and the applied forces Q (Shabana, Dynamics of Multibody Systems, from which the thesis takes its section 4.2). The
motion being given, the multipliers follow from one linear system. -Cq^T lambda are the forces with which the joints
act on the bodies; that of the driving constraint (4.9) is the torque at the crank.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.mechanics.motion import Motion
from hilplant.mechanics.planar import Driving, Ground, Pin, Revolute, Rigid
from hilplant.mechanics.wiper import Wiper


class CrankMotion(NamedTuple):
    """Speed [rad/s] and acceleration [rad/s2] of the crank, numbers or one for each crank angle [m]."""

    speed_rad_s: Floats | float
    acceleration_rad_s2: Floats | float


@dataclass(frozen=True, slots=True)
class AppliedForce:
    """A force from outside [N], [m, 2], that acts on a point of a body."""

    pin: Pin
    force_n: Floats


@dataclass(frozen=True, slots=True)
class JointLoad:
    """What a joint carries: force [N] [m, 2] and moment [N m] [m] with which `second` acts on `first` at `pin`.

    In a joint that turns the moment is that of its damping. Where the wiper is held, `first` is the ground and `second`
    the car.
    """

    first: str
    second: str
    pin: Pin
    force_n: Floats
    moment_n_m: Floats


@dataclass(frozen=True, slots=True)
class Loads:
    """Crank torque [N m] [m], positive in the direction of positive crank speed, and the joints in their order."""

    crank_torque_n_m: Floats
    joints: tuple[JointLoad, ...]


def inverse_dynamics(wiper: Wiper, moving: Motion, crank: CrankMotion, applied: Sequence[AppliedForce] = ()) -> Loads:
    """Return what it takes to move the wiper as given.

    Parameters
    ----------
    wiper
        Bodies, joints and masses.
    moving
        Positions, and derivatives by the crank angle.
    crank
        How the crank moves at each position.
    applied
        Forces on the blades, or on any other point. Gravity and the damping of the pivots are in already.

    """
    forces = _gravity(wiper, moving) - _masses(wiper) * _accelerations(moving, crank)
    damping = _damping(wiper, moving, crank)
    for (first, second), moment in damping.items():
        forces[:, wiper.mechanism.angle(first)] += moment
        forces[:, wiper.mechanism.angle(second)] -= moment
    for force in applied:
        forces += _generalised(wiper, moving, force)
    transposed = np.swapaxes(wiper.mechanism.jacobian(moving.coordinates), -1, -2)
    multipliers = np.asarray(np.linalg.solve(transposed, forces[..., np.newaxis])[..., 0], dtype=np.float64)
    return _sorted(wiper, multipliers, damping)


def _accelerations(moving: Motion, crank: CrankMotion) -> Floats:
    speed, acceleration = (np.asarray(value, dtype=np.float64)[..., np.newaxis] for value in crank)
    return np.asarray(moving.rates * acceleration + moving.accelerations * speed**2)


def _masses(wiper: Wiper) -> Floats:
    """Return the diagonal of the mass matrix: the origins are the centres of mass."""
    return np.stack([wiper.masses_kg, wiper.masses_kg, wiper.inertias_kg_m2], axis=-1).ravel()


def _gravity(wiper: Wiper, moving: Motion) -> Floats:
    forces = np.zeros(moving.coordinates.shape)
    forces[:, 1::3] = -wiper.masses_kg * wiper.gravity_m_s2  # (4.48)
    return forces


def _damping(wiper: Wiper, moving: Motion, crank: CrankMotion) -> dict[tuple[str, str], Floats]:
    """Return the moments [N m] [m] with which the second body acts on the first in the pivots of crank and rockers."""
    held = {joint.body for joint in wiper.joints if isinstance(joint, Ground)}
    moments = {}
    for joint in wiper.joints:
        if isinstance(joint, Revolute):
            names = joint.first[0], joint.second[0]
            for body, base, sign in ((*names, -1.0), (*names[::-1], 1.0)):
                if body in wiper.pivoted and base in held:
                    rate = moving.rates[:, wiper.mechanism.angle(body)]
                    moments[names] = sign * wiper.pivot_damping_n_m_s * rate * crank.speed_rad_s
    return moments


def _generalised(wiper: Wiper, moving: Motion, applied: AppliedForce) -> Floats:
    """Return the forces and the moment about the body's centre."""
    body = wiper.mechanism.bodies[applied.pin[0]]
    arm = wiper.mechanism.point(moving.coordinates, applied.pin) - moving.coordinates[:, 3 * body : 3 * body + 2]
    forces = np.zeros(moving.coordinates.shape)
    forces[:, 3 * body : 3 * body + 2] = applied.force_n
    forces[:, 3 * body + 2] = arm[:, 0] * applied.force_n[..., 1] - arm[:, 1] * applied.force_n[..., 0]
    return forces


def _sorted(wiper: Wiper, multipliers: Floats, damping: Mapping[tuple[str, str], Floats]) -> Loads:
    """Give the multipliers their names, in the order of the constraint equations."""
    row, torque, loads = 0, np.zeros(len(multipliers)), []
    none = np.zeros(len(multipliers))
    for joint in wiper.joints:
        force = -multipliers[:, row : row + 2]
        match joint:
            case Ground(body):
                loads.append(JointLoad(body, "car", (body, (0.0, 0.0)), force, -multipliers[:, row + 2]))
                row += 3
            case Revolute(first, second):
                moment = damping.get((first[0], second[0]), none)
                loads.append(JointLoad(first[0], second[0], first, force, moment))
                row += 2
            case Rigid(first, second):
                loads.append(JointLoad(first[0], second[0], first, force, multipliers[:, row + 2]))
                row += 3
            case Driving():
                torque = -multipliers[:, row]
                row += 1
    return Loads(torque, tuple(loads))
