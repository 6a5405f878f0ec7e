"""Where every body of a wiper is at given crank angles, and how it moves there."""

from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.mechanics.newton_raphson import accelerations, positions, rates
from hilplant.mechanics.planar import Pin
from hilplant.mechanics.turn import FOLLOWED
from hilplant.mechanics.wiper import Wiper, WiperSide
from hilplant.units import TURN_RAD


@dataclass(frozen=True, slots=True)
class Motion:
    """Coordinates of all bodies and their derivatives by the crank angle.

    Attributes
    ----------
    crank_rad
        Crank angles [m], 0 at park.
    coordinates, rates, accelerations
        q, dq/d theta and d2q/d theta2 [m, n]. At the crank's speed w and acceleration a the velocities are rates w
        and the accelerations rates a + accelerations w^2.

    """

    crank_rad: Floats
    coordinates: Floats
    rates: Floats
    accelerations: Floats


@dataclass(frozen=True, slots=True)
class PointMotion:
    """One point of a body: where it is [m] and its derivatives by the crank angle [m/rad, m/rad2], each [m, 2]."""

    place: Floats
    rate: Floats
    acceleration: Floats


def motion(wiper: Wiper, crank_rad: Floats) -> Motion:
    """Solve the wiper at any crank angles [m], in any order.

    Each position is begun at the nearest one of the followed turn, so that it is one that the wiper can reach.

    Raises
    ------
    SolutionError
        When a position is not found.

    """
    linkage = wiper.linkage
    crank_rad = np.asarray(crank_rad, dtype=np.float64)
    within = np.remainder(crank_rad, TURN_RAD)
    nearest = np.rint(within * (FOLLOWED / TURN_RAD)).astype(np.intp)
    ahead = within - nearest * (TURN_RAD / FOLLOWED)
    start = wiper.turn.coordinates[nearest] + wiper.turn.rates[nearest] * ahead[:, np.newaxis]
    solved = positions(linkage, start, wiper.park_rad + within)
    bare = Motion(crank_rad, solved, rates(linkage, solved), accelerations(linkage, solved))
    return _with_arms(wiper, bare)


def _with_arms(wiper: Wiper, bare: Motion) -> Motion:
    """Add the arms and blades, which move with their rockers as one body, to the motion of the linkage."""
    columns = [[bare.coordinates], [bare.rates], [bare.accelerations]]
    for side in wiper.sides:
        angle = wiper.mechanism.angle(side.rocker)
        turning = [values[:, angle, np.newaxis] for values in (bare.coordinates, bare.rates, bare.accelerations)]
        for pin, offset_rad in side.fixed:
            origin = point_motion(wiper, bare, pin)
            columns[0] += [origin.place, turning[0] + offset_rad]
            columns[1] += [origin.rate, turning[1]]
            columns[2] += [origin.acceleration, turning[2]]
    return Motion(bare.crank_rad, *(np.concatenate(column, axis=1) for column in columns))


def forward_sense(wiper: Wiper, side: WiperSide) -> float:
    """Return the sign of the rocker's rate in the forward wipe, the half of the turn in which the arm leaves park.

    Park is crank angle 0, near one end of the sweep; forward leads from there to the other end.
    """
    rocker_rad = wiper.turn.coordinates[:, wiper.mechanism.angle(side.rocker)]
    above, below = rocker_rad.max() - rocker_rad[0], rocker_rad[0] - rocker_rad.min()
    return 1.0 if above > below else -1.0


def point_motion(wiper: Wiper, moving: Motion, pin: Pin) -> PointMotion:
    """Return how one point of a body moves, the derivatives of (4.4)."""
    first, angle = 3 * wiper.mechanism.bodies[pin[0]], wiper.mechanism.angle(pin[0])
    place = wiper.mechanism.point(moving.coordinates, pin)
    arm = place - moving.coordinates[:, first : first + 2]
    across = np.stack([-arm[:, 1], arm[:, 0]], axis=-1)
    turn, turn_of_turn = moving.rates[:, angle, np.newaxis], moving.accelerations[:, angle, np.newaxis]
    rate = moving.rates[:, first : first + 2] + turn * across
    acceleration = moving.accelerations[:, first : first + 2] + turn_of_turn * across - turn**2 * arm
    return PointMotion(place, rate, acceleration)
