"""The no-load torque of any linkage as two polynomials, section 6.3 of Dooner (2016).

A linkage without arms and blades needs the torque of its inertia, M'(angle) w^2/2, and of what little damping its
pivots have. The thesis gives neither masses nor damping for its fit; here both are those of the bench's linkage.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.polynomial import polynomial
from scipy.optimize import minimize

from hilplant import __version__
from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench
from hilplant.bench.load_files import POLYNOMIAL_FORMAT
from hilplant.bench.parameter_hash import linkage_hash
from hilplant.failure import Failure
from hilplant.mechanics.tables import exact_rows
from hilplant.mechanics.wiper import Wiper
from hilplant.models.tables import DAMPING, INERTIA
from hilplant.train.writing import data_hash
from hilplant.units import TURN_RAD

#: Five speeds of the crank [rad/s], and points of a turn: N of (6.4).
SPEEDS_RAD_S = (2.0, 3.0, 4.0, 5.0, 6.0)
POINTS = 1001

FORWARD_DEGREE, REVERSE_DEGREE = 4, 7


@dataclass(frozen=True, slots=True)
class Shape:
    """Torque of a linkage over the angles [m]: what grows with the speed, and what with its square."""

    angles: Floats
    by_speed: Floats
    by_square: Floats

    def torque(self, speed_rad_s: float) -> Floats:
        """Return the torque at the crank [N m]."""
        return self.by_speed * speed_rad_s + self.by_square * speed_rad_s**2


@dataclass(frozen=True, slots=True)
class Polynomials:
    """Coefficients of (6.1), (6.2), constants first, and those of (6.3)."""

    forward: Floats
    reverse: Floats
    c1: float
    c2: float

    def shape(self, angles: Floats) -> Floats:
        """Return f or g of the sine of the angle."""
        x = np.sin(angles)
        forward, reverse = (polynomial.polyval(x, coefficients) for coefficients in (self.forward, self.reverse))
        shape: Floats = np.where(x >= 0.0, forward, reverse)
        return shape

    def torque(self, angles: Floats, speed_rad_s: float) -> Floats:
        """Return the torque of (6.3) [N m]."""
        return speed_rad_s * self.c2 * (self.shape(angles) + speed_rad_s * self.c1)


def no_load_shape(wiper: Wiper, points: int = POINTS) -> Shape:
    """Return the torque of the linkage alone; arms and blades have no mass in it."""
    own = set(wiper.linkage.bodies)
    kept = np.array([body.name in own for body in wiper.bodies])
    bare = replace(wiper, masses_kg=wiper.masses_kg * kept, inertias_kg_m2=wiper.inertias_kg_m2 * kept)
    if not bare.masses_kg.any():
        raise Failure("the linkage has no masses_kg, so it has no torque of inertia to fit")
    angles = np.linspace(0.0, TURN_RAD, points, endpoint=False)
    rows = exact_rows(bare, angles)
    return Shape(angles, rows[:, DAMPING, 0], 0.5 * rows[:, INERTIA, 1])


def fit(shape: Shape, speeds_rad_s: Sequence[float] = SPEEDS_RAD_S) -> Polynomials:
    """Return the polynomials and constants with the least cost over all speeds.

    (6.3) is linear in the coefficients times C2 and in C1 C2, so least squares over all speeds gives them together; the
    largest value of the shape is then made 1. From there C1 and C2 alone bring the cost (6.5), a sum of absolute
    values, down by Nelder and Mead.
    """
    x = np.sin(shape.angles)
    powers = np.column_stack([np.where(x >= 0.0, x**k, 0.0) for k in range(FORWARD_DEGREE + 1)]
                             + [np.where(x < 0.0, x**k, 0.0) for k in range(REVERSE_DEGREE + 1)])  # fmt: skip
    rows = [np.column_stack([v * powers, np.full(len(x), v * v)]) for v in speeds_rad_s]
    targets = np.concatenate([shape.torque(v) for v in speeds_rad_s])
    found = np.linalg.lstsq(np.concatenate(rows), targets, rcond=None)[0]
    size = float(np.abs(powers @ found[:-1]).max())
    forward, reverse = np.split(found[:-1] / size, [FORWARD_DEGREE + 1])
    unit = Polynomials(forward, reverse, 0.0, 1.0)
    start = np.array([found[-1] / size, size])

    def cost_of(constants: Floats) -> float:
        return cost(shape, replace(unit, c1=float(constants[0]), c2=float(constants[1])), speeds_rad_s)

    best = minimize(cost_of, start, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-12, "maxiter": 4000}).x
    return replace(unit, c1=float(best[0]), c2=float(best[1]))


def cost(shape: Shape, fitted: Polynomials, speeds_rad_s: Sequence[float] = SPEEDS_RAD_S) -> float:
    """Return (6.5): the sum over the speeds of the mean absolute errors, by (6.4) [N m]."""
    return sum(
        float(np.abs(shape.torque(v) - fitted.torque(shape.angles, v)).sum()) / len(shape.angles) for v in speeds_rad_s
    )


def errors(shape: Shape, fitted: Polynomials, speeds_rad_s: Sequence[float]) -> dict[str, float]:
    """Return sizes of the error [N m] over angles and speeds, where the worst is, and the share explained."""
    truth = np.array([shape.torque(v) for v in speeds_rad_s])
    found = np.array([fitted.torque(shape.angles, v) for v in speeds_rad_s])
    away = np.abs(found - truth)
    row, column = np.unravel_index(int(away.argmax()), away.shape)
    return {
        "mean_abs_n_m": float(away.mean()),
        "rms_n_m": float(np.sqrt(np.mean(away**2))),
        "worst_n_m": float(away.max()),
        "worst_angle_rad": float(shape.angles[column]),
        "worst_speed_rad_s": float(speeds_rad_s[int(row)]),
        "variance_n_m_2": float(truth.var()),
        "share_explained": max(0.0, 1.0 - float(np.mean(away**2)) / float(truth.var())),
    }


def content_of(bench: Bench, shape: Shape, fitted: Polynomials) -> dict[str, Any]:
    """Return what the file says."""
    return {
        "format": POLYNOMIAL_FORMAT,
        "bench": bench.name,
        "command": f"hilplant train polynomial {bench.name}",
        "version": __version__,
        "parameter_hash": linkage_hash(bench.plant.mechanics.written),
        "data_hash": data_hash(shape.by_speed, shape.by_square),
        "forward": fitted.forward.tolist(),
        "reverse": fitted.reverse.tolist(),
        "c1": fitted.c1,
        "c2": fitted.c2,
        "training": {"speeds_rad_s": list(SPEEDS_RAD_S), "points_of_a_wipe": POINTS},
        "errors": {"cost_n_m": cost(shape, fitted), **errors(shape, fitted, SPEEDS_RAD_S)},
    }
