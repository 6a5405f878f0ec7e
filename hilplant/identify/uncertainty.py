"""How sure the parameters are: covariance, and what the data cannot tell, from the derivatives of stage 3.

A parameter is identifiable when its 95 % interval is narrower than half of its search space (5.22). One that is not
is named, with those that it cannot be told from, and with an experiment that would tell it.
"""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.identify.coefficient_errors import BLOCK_S
from hilplant.identify.local_search import Solution
from hilplant.identify.parameters import search_space

#: Two-sided 95 % of the normal distribution, and the rise of the sum of squares that belongs to it.
NORMAL_95, RISE_95 = 1.959964, 3.841459
#: Singular values below this are 0: no simulation is that exact.
LEAST = 1e-6
#: Beyond this correlation two parameters cannot be told apart.
TOGETHER = 0.9


class Spread(NamedTuple):
    """Covariance of the scaled unknowns, and by how much correlated errors widen each variance (1: not at all)."""

    covariance: Floats
    widening: Floats


class Identifiability(NamedTuple):
    """What the data say of one parameter, to first order; `together` are those that it cannot be told from."""

    name: str
    value: float
    standard_error: float
    identifiable: bool
    together: tuple[str, ...]


def spread(solution: Solution) -> Spread:
    """Return the covariance of the unknowns.

    Where the model is wrong, or the noise coloured, residuals hang together and say less than their number: their sums
    over blocks are compared with what independent ones would give, along each singular direction; the larger counts.
    """
    left, size, vectors = np.linalg.svd(solution.jacobian, full_matrices=False)
    size = np.maximum(size, LEAST)
    scale = solution.variance
    blocks = _block_sums(solution, left)
    along = np.maximum(1.0, np.sum(blocks**2, axis=0) / scale)
    independent, widened = vectors.T / size, vectors.T * (np.sqrt(along) / size)
    covariance = scale * widened @ widened.T
    return Spread(covariance, np.sum(widened**2, axis=1) / np.sum(independent**2, axis=1))


def _block_sums(solution: Solution, left: Floats) -> Floats:
    """Return sums over blocks of residual times direction, [blocks, directions]; each park edge is a block."""
    sums, runs = [], solution.problem.runs
    for run, (currents, edges) in zip(runs, solution.problem.parts(), strict=True):
        products = left[currents] * solution.residuals[currents, np.newaxis]
        count = max(1, round(len(products) * run.period_s / BLOCK_S))
        sums += [block.sum(axis=0) for block in np.array_split(products, count)]
        sums += list(left[edges] * solution.residuals[edges, np.newaxis])
    return np.array(sums)


def verdicts(solution: Solution, known: Spread) -> list[Identifiability]:
    """Say of each parameter whether the data tell it."""
    problem = solution.problem
    count, names = problem.parameters, problem.choice.names
    errors = np.sqrt(np.diag(known.covariance))[:count]
    low, high = search_space(problem.choice, solution.values)
    ranges = (high - low) / problem.scale[:count]
    identifiable = 2.0 * NORMAL_95 * errors < 0.5 * ranges
    correlation = known.covariance[:count, :count] / np.outer(errors, errors)
    found = []
    for index, name in enumerate(names):
        near = [other for other in range(count) if other != index and abs(correlation[index, other]) > TOGETHER]
        together = () if identifiable[index] else tuple(names[other] for other in near if not identifiable[other])
        error = float(errors[index] * problem.scale[index])
        found.append(Identifiability(name, float(solution.values[index]), error, bool(identifiable[index]), together))
    return found


def correlation(solution: Solution, known: Spread) -> Floats:
    """Return the correlation of the parameters."""
    count = solution.problem.parameters
    errors = np.sqrt(np.diag(known.covariance))[:count]
    return np.asarray(known.covariance[:count, :count] / np.outer(errors, errors), np.float64)
