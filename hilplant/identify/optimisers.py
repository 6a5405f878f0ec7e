"""Global searches by name: the genetic algorithm of the thesis, and two maintained ones beside it.

All take the same arguments and evaluate whole populations at a time, so that one call runs on all processors.
"""

import math
import warnings
from collections.abc import Callable

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.identify.genetic import Evaluate, Generation, OnGeneration, Outcome, SearchSettings, Space, genetic

Search = Callable[[Evaluate, Space, SearchSettings, int, OnGeneration], Outcome]


class _Watched:
    """Evaluates within the unit cube, keeps the best, and tells of each population."""

    def __init__(self, evaluate: Evaluate, space: Space, on_generation: OnGeneration) -> None:
        self.evaluate, self.space, self.on_generation = evaluate, space, on_generation
        self.best, self.cost, self.history = space.low, math.inf, list[Generation]()
        self.evaluations = 0

    def __call__(self, shares: Floats) -> Floats:
        sets = self.space.low + np.clip(shares, 0.0, 1.0) * (self.space.high - self.space.low)
        costs = self.evaluate(sets)
        self.evaluations += len(sets)
        first = int(np.argmin(costs))
        if costs[first] < self.cost:
            self.best, self.cost = sets[first].copy(), float(costs[first])
        self.history.append(Generation(self.evaluations, self.cost, float(np.mean(costs))))
        self.on_generation(self.history[-1])
        return costs

    @property
    def outcome(self) -> Outcome:
        return Outcome(self.best, self.cost, tuple(self.history))


def budget(settings: SearchSettings) -> int:
    """Return how many evaluations the others may make: what the genetic algorithm would make at most."""
    return settings.population * (settings.generations + 1)


def evolution_strategy(
    evaluate: Evaluate, space: Space, settings: SearchSettings, seed: int, on_generation: OnGeneration
) -> Outcome:
    """Search by covariance matrix adaptation (package cma), started anew with another seed where it settles early.

    It does not keep the order (3.32).
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it warns that optional plots are not installed
        import cma

    watched, most = _Watched(evaluate, space, on_generation), budget(settings)
    random = np.random.default_rng(seed)
    state = np.random.get_state()  # the package draws from the global generator
    begin = np.full(len(space.low), 0.5)
    try:
        while watched.evaluations + settings.population <= most:
            options = {"bounds": [0.0, 1.0], "popsize": settings.population, "verbose": -9}
            options["seed"] = int(random.integers(1, 2**31))
            strategy = cma.CMAEvolutionStrategy(begin, 0.3, options)
            while not strategy.stop() and watched.evaluations + settings.population <= most:
                asked = strategy.ask()
                strategy.tell(asked, watched(np.array(asked)).tolist())
                if watched.cost < settings.enough:
                    return watched.outcome
            begin = random.random(len(begin))
    finally:
        np.random.set_state(state)
    return watched.outcome


def differential_evolution(
    evaluate: Evaluate, space: Space, settings: SearchSettings, seed: int, on_generation: OnGeneration
) -> Outcome:
    """Search by differential evolution (scipy). It does not keep the order (3.32)."""
    from scipy.optimize import differential_evolution as scipy_search

    watched, random = _Watched(evaluate, space, on_generation), np.random.default_rng(seed)
    size = len(space.low)
    scipy_search(
        lambda columns: watched(columns.T), [(0.0, 1.0)] * size, init=random.random((settings.population, size)),
        maxiter=budget(settings) // settings.population - 1, tol=0.0, atol=0.0, polish=False, updating="deferred",
        vectorized=True, rng=random, callback=lambda intermediate_result: watched.cost < settings.enough,
    )  # fmt: skip
    return watched.outcome


OPTIMISERS: dict[str, Search] = {
    "genetic": genetic,
    "cma": evolution_strategy,
    "de": differential_evolution,
}


def optimiser(name: str) -> Search:
    """Return a global search by its name.

    Raises
    ------
    Failure
        For a name that is none.

    """
    if name not in OPTIMISERS:
        raise Failure(f"there is no optimiser '{name}'; known: {', '.join(OPTIMISERS)}")
    return OPTIMISERS[name]
