"""Drag and lift coefficients of the blades, constant or over the arm's angle, section 4.5, Figure 4-28."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.units import RAD_PER_DEG

#: A number, or pairs of arm angle [deg] and coefficient with rising angles.
Coefficient = float | Sequence[tuple[float, float]]

#: How far beyond its last pair a table is used: angles are written with few digits [deg].
MARGIN_DEG = 1e-6


class CoefficientError(Failure):
    """A coefficient that is no number, or a table that is not one or too short for the arm's sweep."""


@dataclass(frozen=True, slots=True)
class Aerodynamics:
    """Area of a blade [m2] and its coefficients of (4.51), (4.52); positive lift acts away from the screen."""

    area_m2: float = 0.0
    drag: Coefficient = 0.0
    lift: Coefficient = 0.0


def check_aerodynamics(owner: str, air: Aerodynamics) -> None:
    """Refuse an area or coefficients that mean nothing; `owner` is named in the message."""
    if not (math.isfinite(air.area_m2) and air.area_m2 >= 0.0):
        raise CoefficientError(f"{owner}: area_m2 must be a number of at least 0, not {air.area_m2}")
    for name, coefficient in (("drag", air.drag), ("lift", air.lift)):
        _check(f"{owner}: {name}", coefficient)


def _check(owner: str, coefficient: Coefficient) -> None:
    if isinstance(coefficient, int | float):
        if not math.isfinite(coefficient):
            raise CoefficientError(f"{owner} must be a finite number, not {coefficient}")
        return
    pairs = [tuple(pair) for pair in coefficient]
    if len(pairs) < 2 or any(len(pair) != 2 or not all(map(math.isfinite, pair)) for pair in pairs):
        raise CoefficientError(f"{owner} must be a number or at least two pairs [arm angle in deg, coefficient]")
    for (before, _), (after, _) in itertools.pairwise(pairs):
        if after <= before:
            raise CoefficientError(f"{owner}: the arm's angles must rise, but {after} follows {before} deg")


def coefficient_over(owner: str, coefficient: Coefficient, arm_rad: Floats) -> tuple[Floats, Floats]:
    """Return the coefficient and its derivative by the arm's angle [1/rad] at each angle of the arm [rad].

    Between the pairs of a table runs a piecewise cubic that stays between its neighbours and has no kinks
    (Fritsch and Carlson, 1980).

    Raises
    ------
    CoefficientError
        When the arm sweeps beyond the table.

    """
    if isinstance(coefficient, int | float):
        return np.full(arm_rad.shape, float(coefficient)), np.zeros(arm_rad.shape)
    from scipy.interpolate import PchipInterpolator  # slow to load, and few benches have tables

    angle_deg = arm_rad / RAD_PER_DEG
    known_deg, known = np.array(coefficient, dtype=np.float64).T
    lowest, highest = float(angle_deg.min()), float(angle_deg.max())
    if lowest < known_deg[0] - MARGIN_DEG or highest > known_deg[-1] + MARGIN_DEG:
        raise CoefficientError(
            f"{owner}: the table covers {known_deg[0]:.6g} to {known_deg[-1]:.6g} deg, "
            f"but the arm sweeps {lowest:.6g} to {highest:.6g} deg"
        )
    curve = PchipInterpolator(known_deg, known)
    inside = np.clip(angle_deg, known_deg[0], known_deg[-1])
    return np.asarray(curve(inside)), np.asarray(curve(inside, 1) / RAD_PER_DEG)
