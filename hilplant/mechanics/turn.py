"""One turn of the crank, followed from the design position without leaving its branch."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.mechanics.newton_raphson import SolutionError, follow, rates
from hilplant.mechanics.planar import Mechanism
from hilplant.units import TURN_RAD

#: Even steps of the turn.
FOLLOWED = 256
#: How well places [m] and angles [rad] must come back after the turn.
CLOSURE = 1e-9


@dataclass(frozen=True, slots=True)
class Turn:
    """Coordinates and their derivatives by the crank angle [FOLLOWED + 1, n], both ends of the turn included."""

    coordinates: Floats
    rates: Floats


def followed(mechanism: Mechanism, park_rad: float, rockers: Sequence[str]) -> Turn:
    """Follow the mechanism over one turn that begins at an angle of its crank from +X [rad].

    Raises
    ------
    SolutionError
        When a position is not found, when a rocker does not come back to where it began, or when another body stands
        elsewhere after the turn.

    """
    coordinates = follow(mechanism, park_rad + np.linspace(0.0, TURN_RAD, FOLLOWED + 1))
    gap = coordinates[-1] - coordinates[0]
    for rocker in rockers:
        away = gap[mechanism.angle(rocker)]
        if abs(away) > CLOSURE:
            raise SolutionError(
                f"after one turn of the crank the body {rocker} is {away:.3g} rad away from where it began"
            )
    gap[2::3] = np.remainder(gap[2::3] + np.pi, TURN_RAD) - np.pi
    if np.abs(gap).max() > CLOSURE:
        name = list(mechanism.bodies)[int(np.abs(gap).argmax()) // 3]
        raise SolutionError(f"after one turn of the crank the body {name} is not where it began")
    return Turn(coordinates, rates(mechanism, coordinates))
