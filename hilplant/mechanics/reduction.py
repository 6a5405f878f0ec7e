"""The whole wiper seen from the crank: inertia, gravity, drag, and how far each blade point moves.

With one degree of freedom, virtual power at the crank replaces all joint forces. The torque at the crank is
tau = M a + M' w^2 / 2 + G + V^2 D + B w + sum of |J_i| F_i over the blades' points, with
M = sum of m (x'^2 + y'^2) + I phi'^2, M' = 2 sum of m (x' x'' + y' y'') + I phi' phi'', G = sum of m g y',
B = d (1 + left'^2 + right'^2). A dash is a derivative by the crank angle.
"""

from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.mechanics.coefficients import coefficient_over
from hilplant.mechanics.motion import Motion, forward_sense
from hilplant.mechanics.planar import Pin
from hilplant.mechanics.wiper import Wiper, WiperSide


@dataclass(frozen=True, slots=True)
class Curve:
    """A quantity over the crank angle, [m], and its derivative by the crank angle."""

    value: Floats
    slope: Floats


@dataclass(frozen=True, slots=True)
class SideCurves:
    """What one side adds.

    Attributes
    ----------
    rocker
        The rocker's angle [rad].
    inertia, gravity
        What arm and blade have of the wiper's inertia [kg m2] and torque of gravity [N m].
    drag
        Torque of the drag at the crank by the square of the air's speed [N m s2/m2], positive against positive crank
        speed.
    lift
        Lift by the square of the air's speed [N s2/m2], positive away from the screen.
    points
        dr/d theta of each friction point [m/rad], with the sign of the rocker's rate.

    """

    rocker: Curve
    inertia: Curve
    gravity: Curve
    drag: Curve
    lift: Curve
    points: tuple[Curve, ...]


@dataclass(frozen=True, slots=True)
class Reduction:
    """The wiper at the crank: inertia M [kg m2], gravity torque G [N m], positive against positive speed, blades.

    `damping` B is that of the pivots [N m s/rad].
    """

    inertia: Curve
    gravity: Curve
    damping: Curve
    left: SideCurves
    right: SideCurves

    def moving_torque(self, speed_rad_s: Floats | float, acceleration_rad_s2: Floats | float) -> Floats:
        """Return M a + M' w^2 / 2 + G + B w [N m], the torque that moves the wiper without wind and blade friction."""
        inertial = self.inertia.value * acceleration_rad_s2 + self.inertia.slope * (np.square(speed_rad_s) / 2.0)
        return np.asarray(inertial + self.gravity.value + self.damping.value * speed_rad_s)


def reduce(wiper: Wiper, moving: Motion) -> Reduction:
    """Return the wiper as seen from the crank.

    Raises
    ------
    CoefficientError
        When a table of drag or lift does not reach over the arm's sweep.

    """
    left, right = (_side(wiper, moving, side) for side in wiper.sides)
    return Reduction(_inertia(wiper, moving), _gravity(wiper, moving), _damping(wiper, moving), left, right)


def _inertia(wiper: Wiper, moving: Motion, of: Floats | float = 1.0) -> Curve:
    """Return the inertia; `of` has 1 for each body that counts, 0 for the others."""
    masses_kg, inertias_kg_m2 = wiper.masses_kg * of, wiper.inertias_kg_m2 * of
    weights = np.stack([masses_kg, masses_kg, inertias_kg_m2], axis=-1).ravel()
    return Curve(moving.rates**2 @ weights, 2.0 * (moving.rates * moving.accelerations) @ weights)


def _gravity(wiper: Wiper, moving: Motion, of: Floats | float = 1.0) -> Curve:
    weights = wiper.masses_kg * of * wiper.gravity_m_s2
    return Curve(moving.rates[:, 1::3] @ weights, moving.accelerations[:, 1::3] @ weights)


def _damping(wiper: Wiper, moving: Motion) -> Curve:
    """Return what the damping of crank and rockers in their pivots comes to at the crank [N m s/rad]."""
    angles = [wiper.mechanism.angle(name) for name in wiper.pivoted]
    rates, changes = moving.rates[:, angles], moving.accelerations[:, angles]
    damping = wiper.pivot_damping_n_m_s
    return Curve(damping * np.sum(rates**2, axis=1), damping * 2.0 * np.sum(rates * changes, axis=1))


def _side(wiper: Wiper, moving: Motion, side: WiperSide) -> SideCurves:
    angle = wiper.mechanism.angle(side.rocker)
    rocker = Curve(moving.coordinates[:, angle], moving.rates[:, angle])
    change = moving.accelerations[:, angle]
    points = tuple(
        Curve(rocker.slope * radius, change * radius) for radius in (_radius(wiper, side, pin) for pin in side.friction)
    )
    own = np.array([body.name in side.bodies for body in wiper.bodies])
    carried = _inertia(wiper, moving, own), _gravity(wiper, moving, own)
    return SideCurves(rocker, *carried, _drag(wiper, moving, side), _lift(wiper, side, rocker), points)


def _radius(wiper: Wiper, side: WiperSide, pin: Pin) -> float:
    """Return how far a point of the blade is from the arm's pivot [m]; arm and blade turn about it as one body."""
    design = wiper.mechanism.design
    return float(np.linalg.norm(wiper.mechanism.point(design, pin) - wiper.mechanism.point(design, side.pivot)))


def _lift(wiper: Wiper, side: WiperSide, rocker: Curve) -> Curve:
    """Return (4.52) at an air speed of 1 m/s."""
    arm_rad = rocker.value + side.arm.offset_rad
    value, by_angle = coefficient_over(f"{side.name} blade: lift", side.air.lift, arm_rad)
    pressed = 0.5 * wiper.air_density_kg_m3 * side.air.area_m2
    return Curve(pressed * value, pressed * by_angle * rocker.slope)


def _drag(wiper: Wiper, moving: Motion, side: WiperSide) -> Curve:
    """Return (4.51) at an air speed of 1 m/s, acting on the blade's joint along its path in the forward wipe."""
    angle = wiper.mechanism.angle(side.rocker)
    rate, change = moving.rates[:, angle], moving.accelerations[:, angle]
    arm_rad = moving.coordinates[:, angle] + side.arm.offset_rad
    value, by_angle = coefficient_over(f"{side.name} blade: drag", side.air.drag, arm_rad)
    pressed = 0.5 * wiper.air_density_kg_m3 * side.air.area_m2
    against = -forward_sense(wiper, side) * _radius(wiper, side, side.centre) * pressed
    return Curve(against * value * rate, against * (by_angle * rate**2 + value * change))
