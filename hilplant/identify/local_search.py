"""Stage 3: bounded nonlinear least squares over parameters, offsets and starts together, section 5.6."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from hilplant.arrays import Floats
from hilplant.identify.parameters import search_space
from hilplant.identify.residuals import LeastSquares, ResidualNoise, directions, expected_noise

#: Steps of one round, at most, and when it has settled: the sum of squares changes by less than this part of itself.
STEPS, SETTLED = 20, 3e-6
#: Rounds, at most. After each one bounds that were reached are moved on, each so many times at most; once none is
#: reached, weights follow what is left over.
ROUNDS, MOVES = 10, 2
#: Weights are left as they are when they differ from what is left over by less than this factor.
CLOSE = 1.15
#: No weight takes a current for surer than this part of its own restlessness.
SUREST = 0.3
#: A parameter is at its bound when it is this near, in parts of the range.
AT_BOUND = 1e-3


class Solution(NamedTuple):
    """Where the search ended: scaled unknowns, the problem with its last weights, residuals and derivatives there.

    `low` and `high` are the scaled bounds in the end; `moved_on` names parameters that went beyond the first ones.
    """

    x: Floats
    problem: LeastSquares
    residuals: Floats
    jacobian: Floats
    evaluations: int
    low: Floats
    high: Floats
    moved_on: tuple[str, ...]
    settled: bool

    @property
    def values(self) -> Floats:
        """The parameters' values."""
        return self.problem.values(self.x)

    @property
    def noise(self) -> ResidualNoise:
        """What is left: root mean square of current [A] and of edge times [s]."""
        return left_over(self.problem, self.residuals)

    @property
    def variance(self) -> float:
        """Mean square of the residuals, at least that of the surest current: data without noise say no more."""
        surest = SUREST * expected_noise(self.problem.runs).current_a / self.problem.noise.current_a
        return max(float(np.mean(self.residuals**2)), surest**2)


def search(problem: LeastSquares, values: Floats, told: Callable[[float], None] = lambda _: None) -> Solution:
    """Search from parameter values, within (5.22) about them; weights follow what is left over.

    The width of its bounds ties each parameter weakly to where it began: what the data say nothing of stays there
    instead of drifting to a bound. `told` hears the root mean square of the current's error.
    """
    expected = problem.noise
    x = problem.start(values)
    low, high = problem.bounds(*search_space(problem.choice, values))
    moves = dict.fromkeys(problem.choice.names, 0)
    tied, local = _Tied(problem, x, (low, high)), False
    for _ in range(ROUNDS):
        x, settled = tied.settle(x)
        residuals = problem.residuals(x)
        left = left_over(problem, residuals)
        told(left.current_a)
        names = [name for name in _at_bounds(problem, x, low, high) if moves[name] < MOVES]
        if names:
            moves |= {name: moves[name] + 1 for name in names}
            tied.bounds = low, high = _about(problem, x, (low, high), names)
        elif settled and not local:
            tied.problem = problem = problem.localised(x)
            local = True
        elif settled and _close(problem.noise, _weights(left, expected)):
            break
        elif settled:
            tied.problem = problem = problem.with_noise(_weights(left, expected))
    residuals = problem.residuals(x)
    evaluations = tied.evaluations
    jacobian = tied.last_jacobian(x)
    ordered = tuple(name for name, count in moves.items() if count)
    return Solution(x, problem, residuals, jacobian, evaluations, low, high, ordered, settled)


def _weights(left: ResidualNoise, expected: ResidualNoise) -> ResidualNoise:
    """Return weights for what is left over; an edge is never surer than its rounding."""
    return ResidualNoise(max(left.current_a, SUREST * expected.current_a), max(left.edge_s, expected.edge_s))


def _close(one: ResidualNoise, other: ResidualNoise) -> bool:
    ratios = np.array(one) / np.array(other)
    return bool(np.all(ratios < CLOSE) and np.all(ratios > 1.0 / CLOSE))


def _at_bounds(problem: LeastSquares, x: Floats, low: Floats, high: Floats) -> list[str]:
    """Name the parameters that stand at a bound which is not one of nature."""
    names = []
    for place, parameter in enumerate(problem.choice.parameters):
        reach = AT_BOUND * (high[place] - low[place])
        below, above = x[place] < low[place] + reach, x[place] > high[place] - reach
        natural_low, natural_high = (
            low[place] <= 0.0 and not parameter.signed,
            (high[place] * problem.scale[place] >= parameter.highest),
        )
        if (below and not natural_low) or (above and not natural_high):
            names.append(parameter.name)
    return names


def _about(problem: LeastSquares, x: Floats, bounds: tuple[Floats, Floats], names: list[str]) -> tuple[Floats, Floats]:
    """Take the bounds of some parameters by (5.22) about where they are now."""
    low, high = (bound.copy() for bound in bounds)
    new_low, new_high = search_space(problem.choice, problem.values(x))
    for name in names:
        place = problem.choice.names.index(name)
        low[place], high[place] = new_low[place] / problem.scale[place], new_high[place] / problem.scale[place]
    return low, high


def left_over(problem: LeastSquares, residuals: Floats) -> ResidualNoise:
    """Return the root mean square of current errors [A] and of edge errors [s]."""
    currents = np.concatenate([residuals[current] for current, _ in problem.parts()])
    edges = np.concatenate([residuals[edge] for _, edge in problem.parts()])
    return ResidualNoise(
        float(np.sqrt(np.mean(currents**2))) * problem.noise.current_a,
        float(np.sqrt(np.mean(edges**2))) * problem.noise.edge_s,
    )


class _Tied:
    """The problem with a weak tie of each parameter to its start; counts simulations."""

    def __init__(self, problem: LeastSquares, begin: Floats, bounds: tuple[Floats, Floats]) -> None:
        self.problem, self.begin, self.bounds = problem, begin, bounds
        self.evaluations = 0
        self.basis: Floats | None = None

    @property
    def tie(self) -> Floats:
        low, high = self.bounds
        ties = np.zeros(len(low))
        ties[: self.problem.parameters] = 1.0 / (high - low)[: self.problem.parameters]
        return ties

    def settle(self, x: Floats) -> tuple[Floats, bool]:
        """Return where one round leads, and whether it settled there."""
        low, high = self.bounds
        margin = 1e-6 * (high - low)
        found = least_squares(
            self.residuals, np.clip(x, low + margin, high - margin), self.jacobian,
            bounds=(low, high), method="trf", x_scale="jac", max_nfev=STEPS, ftol=SETTLED, xtol=1e-6, gtol=1e-6,
        )  # fmt: skip
        return np.asarray(found.x, np.float64), bool(found.status > 0)

    def residuals(self, x: Floats) -> Floats:
        """Return the residuals, those of the ties behind them."""
        self.evaluations += 1
        return np.concatenate([self.problem.residuals(x), (x - self.begin) * self.tie])

    def jacobian(self, x: Floats) -> Floats:
        """Return the derivatives of all residuals."""
        return np.vstack([self.last_jacobian(x), np.diag(self.tie)])

    def last_jacobian(self, x: Floats) -> Floats:
        """Return the problem's own derivatives; those of the step before say in which directions to look."""
        for _ in range(2 if self.basis is None else 1):
            found = self.problem.jacobian(x, self.basis)
            self.evaluations += 2 * len(self.problem.moved)
            self.basis = directions(found[:, self.problem.moved])
        return found
