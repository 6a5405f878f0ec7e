"""Profile intervals: how far a parameter can go, all others following, before the data speak against it.

All parameters and both sides are walked together, so that each step is one batch of simulations. The others follow by
Gauss-Newton steps with the derivatives of the best point, except along directions that the data do not tell anyway:
over their length no derivative holds. A parameter that hangs on one of these gets the interval of first order instead,
which allows for all of them; a profile without them would be too narrow.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Flags, Floats
from hilplant.identify.local_search import Solution
from hilplant.identify.uncertainty import NORMAL_95, RISE_95, Identifiability, Spread

#: Gauss-Newton steps of the others at each distance, and distances that are tried.
FOLLOWING, DISTANCES = 2, 4
#: The rise is met when it is this near to the wanted one, in parts of it.
NEAR = 0.05
#: A direction in which the standard error is more than this part of the search space is not followed.
LOOSE = 0.25
#: A parameter hangs on directions that are not followed when they make its variance larger by this factor.
HANGS = 1.05


class ConfidenceInterval(NamedTuple):
    """95 % interval; a side is None where the search space ends before the data speak against the value."""

    low: float | None
    high: float | None


def profile(solution: Solution, known: Spread, said: Sequence[Identifiability]) -> list[ConfidenceInterval]:
    """Return the 95 % interval of each parameter; without sides where the data do not tell it.

    The rise is wanted to be that of chi-square with one degree of freedom, times the widening by correlated errors.
    """
    identifiable = [place for place, verdict in enumerate(said) if verdict.identifiable]
    intervals = [ConfidenceInterval(None, None)] * len(said)
    if not identifiable:
        return intervals
    walk = _Walk(solution, known, identifiable)
    ends = np.where(walk.hangs(), walk.first_order(), walk.ends())
    for row, place in enumerate(identifiable):
        intervals[place] = ConfidenceInterval(_finite(ends[row]), _finite(ends[row + len(identifiable)]))
    return intervals


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


class _Walk:
    """Parameters held at distances from the best point: all downwards, then all upwards, a row for each."""

    def __init__(self, solution: Solution, known: Spread, places: list[int]) -> None:
        self.solution = solution
        self.held, self.sign = np.tile(places, 2), np.repeat([-1.0, 1.0], len(places))
        self.variance = solution.variance * known.widening[self.held]
        self.wanted = RISE_95 * self.variance
        self.errors = np.sqrt(np.diag(known.covariance))[self.held]
        bound = np.where(self.sign < 0.0, solution.low[self.held], solution.high[self.held])
        self.reach = np.abs(bound - solution.x[self.held])
        self.distance = np.minimum(NORMAL_95 * self.errors, self.reach)
        self.gains = {place: _gain(solution, place) for place in places}

    def ends(self) -> Floats:
        """Return where the rise is the wanted one; not finite where the bound comes first."""
        for _ in range(DISTANCES):
            ratio = self.rises() / self.wanted
            met = self.distance / np.sqrt(np.maximum(ratio, 1e-3))
            beyond = (ratio < 1.0) & (self.distance >= self.reach * (1.0 - 1e-9))
            if np.all(beyond | (np.abs(ratio - 1.0) < NEAR)):
                break
            met = np.clip(met, 0.3 * self.distance, 3.0 * self.distance)
            self.distance = np.minimum(met, self.reach)
        return np.where(beyond, np.inf, self._values(met))

    def hangs(self) -> Flags:
        """Say of which ends the variance to first order is larger than with the followed directions alone."""
        jacobian, rows = self.solution.jacobian, []
        for place in self.held:
            column = jacobian[:, place]
            slopes = jacobian.T @ column
            rows.append(float(column @ column - slopes @ self.gains[place] @ slopes))
        followed = self.variance / np.maximum(rows, 1e-300)
        return np.asarray(self.errors**2 > HANGS * followed, np.bool_)

    def first_order(self) -> Floats:
        """Return the ends by the standard error; not finite where the bound comes first."""
        distance = NORMAL_95 * self.errors
        return np.where(distance < self.reach, self._values(distance), np.inf)

    def _values(self, distance: Floats) -> Floats:
        scale = self.solution.problem.scale[self.held]
        return np.asarray((self.solution.x[self.held] + self.sign * distance) * scale, np.float64)

    def rises(self) -> Floats:
        """Return how much the sum of squares rises at the distances, the others following."""
        solution, rows = self.solution, range(len(self.held))
        jacobian, problem = solution.jacobian, solution.problem
        steps = self.sign * self.distance
        x = np.tile(solution.x, (len(self.held), 1))
        x[rows, self.held] += steps
        begin = solution.residuals @ jacobian  # not 0 where the ties hold the best point
        for row, place in enumerate(self.held):
            x[row] -= self.gains[place] @ (jacobian.T @ (jacobian[:, place] * steps[row]))
        least = np.full(len(self.held), np.inf)
        for count in range(FOLLOWING + 1):
            residuals = problem.simulated(np.clip(x, solution.low, solution.high))
            least = np.minimum(least, np.sum(residuals**2, axis=1) - np.sum(solution.residuals**2))
            if count < FOLLOWING:
                slopes = residuals @ jacobian - begin
                x -= np.stack([self.gains[place] @ slopes[row] for row, place in enumerate(self.held)])
        return least


def _gain(solution: Solution, held: int) -> Floats:
    """Return what turns a slope of the other unknowns into their Gauss-Newton step."""
    others = np.delete(np.arange(len(solution.x)), held)
    widths = np.ones(len(solution.x))
    count = solution.problem.parameters
    widths[:count] = (solution.high - solution.low)[:count]
    _, size, vectors = np.linalg.svd(np.linalg.qr(solution.jacobian[:, others] * widths[others], mode="r"))
    followed = size > 1.0 / LOOSE
    directions = widths[others, np.newaxis] * vectors[followed].T / size[followed]
    gain = np.zeros((len(solution.x), len(solution.x)))
    gain[np.ix_(others, others)] = directions @ directions.T
    return gain
