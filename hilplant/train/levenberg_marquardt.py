"""Least squares by Levenberg and Marquardt, with early stopping on data that the fit does not see.

The step solves (J'J + (damping + decay) 1) d = -(J'r + decay w): between Gauss-Newton where the damping is small and
steepest descent where it is large. The damping falls after a step that lowers the cost, else it grows and the step is
tried again. `decay` pulls every weight a little towards 0, which keeps a network from bending between its data. A fit
that begins with much of it, which then falls, finds smooth shapes first and ends in far better places.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from hilplant.arrays import Floats


class Fitted(Protocol):
    """What is fitted: sums over its own data, and the error on other data."""

    def cost(self, weights: Floats) -> float:
        """Return the sum of the squared residuals."""

    def normal(self, weights: Floats) -> tuple[float, Floats, Floats]:
        """Return the sum of the squared residuals, J'J and J'r."""

    def judged(self, weights: Floats) -> float:
        """Return the mean squared error on the data kept back for judging."""


@dataclass(frozen=True, slots=True)
class DescentSettings:
    """When to stop and how strongly to damp; `patience` is how many epochs the judged error may stay above its best."""

    epochs: int = 400
    patience: int = 40
    decay: float = 1e-4
    first_decay: float = 0.0  # with which the fit begins, where it is larger; it falls with every epoch
    decay_falls: float = 0.93
    first_damping: float = 1e-2
    most_damping: float = 1e10
    tolerance: float = 1e-5  # relative fall of the cost over ten epochs below which nothing more is expected


@dataclass(frozen=True, slots=True)
class Minimum:
    """Where a fit ended: the weights with the least judged error, that error, and the epochs gone through.

    `interrupted` says that the user ended it.
    """

    weights: Floats
    judged: float
    epochs: int
    interrupted: bool = False


def minimise(
    fitted: Fitted, start: Floats, settings: DescentSettings, on_epoch: Callable[[int, float], None] | None = None
) -> Minimum:
    """Return the best weights on the way down from `start`, by the data kept back.

    Parameters
    ----------
    fitted, start, settings
        What to fit, from which weights, and when to stop.
    on_epoch
        Called after each epoch with its number and the judged error. A KeyboardInterrupt, there or elsewhere, ends the
        fit with the best weights so far.

    """
    best = Minimum(start, fitted.judged(start), 0)
    epoch = 0
    try:
        for epoch, weights in enumerate(_descent(fitted, start, settings), start=1):
            judged = fitted.judged(weights)
            if judged < best.judged:
                best = Minimum(weights, judged, epoch)
            if on_epoch is not None:
                on_epoch(epoch, judged)
            if epoch - best.epochs >= settings.patience:
                break
    except KeyboardInterrupt:
        return replace(best, epochs=epoch, interrupted=True)
    return replace(best, epochs=epoch)


def _descent(fitted: Fitted, start: Floats, settings: DescentSettings) -> Iterator[Floats]:
    """Yield the weights after each step, until no step helps or the last ten together hardly did."""
    weights, damping = start, settings.first_damping
    costs: list[float] = []
    for epoch in range(settings.epochs):
        decay = max(settings.decay, settings.first_decay * settings.decay_falls**epoch)
        stepped = _step(fitted, weights, damping, replace(settings, decay=decay))
        if stepped is None:
            return
        weights, damping, cost = stepped
        yield weights
        costs = [*costs[-10:], cost] if decay == settings.decay else []
        if len(costs) > 10 and costs[0] - cost <= settings.tolerance * cost:
            return


def _step(
    fitted: Fitted, weights: Floats, damping: float, settings: DescentSettings
) -> tuple[Floats, float, float] | None:
    """Return weights, damping and cost after a step that lowers the cost; None when none does."""
    decay, ones = settings.decay, np.eye(len(weights))
    error, hessian, gradient = fitted.normal(weights)
    cost = error + decay * float(weights @ weights)
    gradient = gradient + decay * weights
    while damping <= settings.most_damping:
        try:
            change = cho_solve(cho_factor(hessian + (damping + decay) * ones), -gradient)
        except LinAlgError:
            damping *= 10.0
            continue
        trial = weights + change
        reached = fitted.cost(trial) + decay * float(trial @ trial)
        if reached < cost:
            return trial, max(damping * 0.1, 1e-15), reached
        damping *= 10.0
    return None
