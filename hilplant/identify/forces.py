"""Friction force of a blade at given speeds: what data of a wiper do tell, though not force and coefficients apart."""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.identify.local_search import Solution
from hilplant.identify.parameters import Choice
from hilplant.identify.uncertainty import Spread
from hilplant.models.friction import coefficient
from hilplant.models.records import Parameters
from hilplant.models.row import unpack
from hilplant.signals import INPUT_INDEX, SCREENS

#: Speeds of the blade at which the force is told [mm/s].
SPEEDS_MM_S = (20.0, 100.0, 300.0, 1000.0)


class FrictionForce(NamedTuple):
    """Friction force of the left blade [N] at one speed, with its standard error."""

    screen: str
    speed_mm_s: float
    force_n: float
    standard_error_n: float


def friction_forces(solution: Solution, known: Spread) -> list[FrictionForce]:
    """Return the forces on the screens that the data contain."""
    wetness = {float(run.inputs[0, INPUT_INDEX["screen"]]) for run in solution.problem.runs}
    found = []
    for name, screen in SCREENS:
        if screen in wetness:
            found += [_at(solution, known, name, screen, speed) for speed in SPEEDS_MM_S]
    return found


def _at(solution: Solution, known: Spread, name: str, screen: float, speed_mm_s: float) -> FrictionForce:
    problem, count = solution.problem, solution.problem.parameters
    values = solution.values
    steps = 1e-4 * problem.scale[:count]
    moved = np.vstack([values, values + np.diag(steps), values - np.diag(steps)])
    forces = np.array([force(problem.choice, each, screen, speed_mm_s) for each in moved])
    slopes = (forces[1 : count + 1] - forces[count + 1 :]) / (2.0 * steps) * problem.scale[:count]
    variance = float(slopes @ known.covariance[:count, :count] @ slopes)
    return FrictionForce(name, speed_mm_s, float(forces[0]), float(np.sqrt(max(variance, 0.0))))


def force(choice: Choice, values: Floats, screen: float, speed_mm_s: float) -> float:
    """Return the friction force of the left blade [N]."""
    row: Floats = choice.rows(values[np.newaxis])[0]
    load = unpack(Parameters, row).load
    mu, _ = coefficient(speed_mm_s, screen, load.left_blade.force_n, load.friction)
    return float(load.left_blade.wear * load.left_blade.force_n * mu)
