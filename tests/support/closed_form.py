"""A wiper whose load is known in closed form, energies included: to measure the step, and tables, against it.

Its rockers swing as psi(theta) = -a cos(theta) + b sin(2 theta) + c cos(2 theta), which no linkage does exactly but
which has the size, the turning points and the asymmetry of one.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilplant.models import tables as channel
from hilplant.units import TURN_RAD

Floats = NDArray[np.float64]

AIR_DENSITY_KG_M3 = 1.225


@dataclass(frozen=True)
class Side:
    """One arm with its blade, on its rocker."""

    swing: tuple[float, float, float]  # a, b, c [rad]
    length_m: float
    inertia_kg_m2: float
    weight_n_m: float  # torque of gravity with the rocker at psi = 0
    drag_m2: float = 0.0  # area times coefficient
    lift_m2: float = 0.0

    def rocker(self, angle: float) -> tuple[float, float, float]:
        """Return psi [rad] and its first two derivatives by the crank angle."""
        a, b, c = self.swing
        s1, c1, s2, c2 = math.sin(angle), math.cos(angle), math.sin(2.0 * angle), math.cos(2.0 * angle)
        return (
            -a * c1 + b * s2 + c * c2,
            a * s1 + 2.0 * b * c2 - 2.0 * c * s2,
            a * c1 - 4.0 * b * s2 - 4.0 * c * c2,
        )


@dataclass(frozen=True)
class ClosedFormWiper:
    """Two sides, a crank with an inertia of its own, and `points` points of friction on each blade."""

    left: Side = Side((0.71, 0.02, 0.03), 0.69, 0.13, 0.5, 0.07 * 0.175, 0.07 * 0.0517)
    right: Side = Side((0.72, -0.02, 0.04), 0.54, 0.09, 0.4, 0.07 * 0.175, 0.07 * 0.0517)
    crank_inertia_kg_m2: float = 0.002
    points: int = 1
    pivot_damping_n_m_s: float = 0.0

    def energy(self, angle: float, speed: float) -> float:
        """Return kinetic and potential energy [J] at a crank angle [rad] and crank speed [rad/s]."""
        joule = 0.5 * self.crank_inertia_kg_m2 * speed * speed
        for side in (self.left, self.right):
            psi, rate, _ = side.rocker(angle)
            joule += 0.5 * side.inertia_kg_m2 * (rate * speed) ** 2 + side.weight_n_m * math.sin(psi)
        return joule

    def channels(self, angle: float) -> Floats:
        """Return [channels, 2], values and derivatives at a crank angle, in the order of the tables."""
        table = np.zeros((channel.channels(self.points), 2))
        table[channel.INERTIA, 0] = self.crank_inertia_kg_m2
        table[channel.DAMPING, 0] = self.pivot_damping_n_m_s
        pressure = 0.5 * AIR_DENSITY_KG_M3
        for k, side in enumerate((self.left, self.right)):
            psi, rate, bend = side.rocker(angle)
            way = np.array([rate, bend])
            table[channel.LEFT_ROCKER + k] = psi, rate
            squared = rate * np.array([rate, 2.0 * bend])
            table[channel.INERTIA] += side.inertia_kg_m2 * squared
            table[channel.DAMPING] += self.pivot_damping_n_m_s * squared
            pull = rate * math.cos(psi), bend * math.cos(psi) - rate * rate * math.sin(psi)
            table[channel.GRAVITY] += side.weight_n_m * np.array(pull)
            table[channel.DRAG] -= pressure * side.drag_m2 * side.length_m * way
            table[channel.LEFT_LIFT + k, 0] = pressure * side.lift_m2
            first = channel.POINTS + k * self.points
            table[first : first + self.points] = np.outer(self.radii(side), way)
            share = channel.POINTS + 2 * self.points + k * channel.SIDE_CHANNELS
            table[share] = side.inertia_kg_m2 * squared
            table[share + 1] = side.weight_n_m * np.array(pull)
            table[share + 2] = -pressure * side.drag_m2 * side.length_m * way
        return table

    def radii(self, side: Side) -> Floats:
        """Return where the points of the blade are [m], all of them at the arm's end or spread about it."""
        if self.points == 1:
            return np.array([side.length_m])
        return side.length_m * np.linspace(0.6, 1.4, self.points)

    def tables(self, knots: int = 1024) -> Floats:
        """Return the tables over one turn of the crank."""
        tables = np.array([self.channels(angle) for angle in np.linspace(0.0, TURN_RAD, knots + 1)])
        tables[-1] = tables[0]
        return np.ascontiguousarray(tables)
