"""The genetic algorithm of stage 2 (5.5, Appendix E), with the settings of Table 5-7.

Half of the population survives. Parents are the best of three drawn at random; a random number of genes of each pair is
blended, (5.27) and (5.28); genes are mutated anywhere but in the elite. Only individuals that changed are evaluated.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from hilplant.arrays import Flags, Floats

Evaluate = Callable[[Floats], Floats]


class Space(NamedTuple):
    """Where to search: bounds, and pairs (greater, smaller) of places that are to stay in order, (3.32)."""

    low: Floats
    high: Floats
    ordered: tuple[tuple[int, int], ...] = ()


class SearchSettings(NamedTuple):
    """Table 5-7. The search ends early where a cost falls below `enough`."""

    population: int = 40
    kept_part: float = 0.5
    elite: int = 5
    mutation_rate: float = 0.1
    generations: int = 200
    contenders: int = 3
    enough: float = 0.0


class Generation(NamedTuple):
    """One generation: evaluations so far, the lowest cost so far, the mean of the population."""

    evaluations: int
    best: float
    mean: float


OnGeneration = Callable[[Generation], None]


class Outcome(NamedTuple):
    """What a search found: the best values, their cost, and how it came there."""

    values: Floats
    cost: float
    history: tuple[Generation, ...]


def genetic(
    evaluate: Evaluate, space: Space, settings: SearchSettings, seed: int, on_generation: OnGeneration = lambda _: None
) -> Outcome:
    """Search the space; the same seed gives the same result, bit for bit."""
    random = np.random.default_rng(seed)
    people = first_population(random, space, settings.population)
    costs, evaluations, history = evaluate(people), settings.population, []
    keep = math.floor(settings.kept_part * settings.population)
    for generation in range(settings.generations + 1):
        order = np.argsort(costs, kind="stable")
        people, costs = people[order], costs[order]
        history.append(Generation(evaluations, float(costs[0]), float(np.mean(costs))))
        on_generation(history[-1])
        if generation == settings.generations or costs[0] < settings.enough:
            break
        known = {person.tobytes(): cost for person, cost in zip(people, costs, strict=True)}
        people[keep:] = offspring(random, people[:keep], costs[:keep], settings, space)
        mutate(random, people, settings, space)
        changed = np.array([person.tobytes() not in known for person in people])
        costs[~changed] = [known[person.tobytes()] for person in people[~changed]]
        costs[changed] = evaluate(people[changed])
        evaluations += int(np.count_nonzero(changed))
    return Outcome(people[0].copy(), float(costs[0]), tuple(history))


def first_population(random: Generator, space: Space, count: int) -> Floats:
    """Draw individuals evenly from the space, in order where that is asked for."""
    shares = random.random((count, len(space.low)))
    people = np.asarray(space.low + shares * (space.high - space.low), np.float64)
    for greater, smaller in space.ordered:
        top = np.minimum(space.high[smaller], np.maximum(people[:, greater], space.low[smaller]))
        people[:, smaller] = space.low[smaller] + shares[:, smaller] * (top - space.low[smaller])
    return people


def offspring(random: Generator, parents: Floats, costs: Floats, settings: SearchSettings, space: Space) -> Floats:
    """Return two children of each pair of tournament winners until the population is full again."""
    wanted, genes = settings.population - len(parents), parents.shape[1]
    children = np.empty((wanted + wanted % 2, genes))
    for place in range(0, len(children), 2):
        mother, father = (parents[_winner(random, costs, settings.contenders)] for _ in range(2))
        blended = random.permutation(genes)[: random.integers(1, genes + 1)]
        share = random.random() * (mother[blended] - father[blended])
        children[place], children[place + 1] = mother, father
        children[place, blended] = mother[blended] - share
        children[place + 1, blended] = father[blended] + share
    for greater, smaller in space.ordered:
        limit = np.maximum(children[:, greater], space.low[smaller])
        children[:, smaller] = np.minimum(children[:, smaller], limit)
    return children[:wanted]


def _winner(random: Generator, costs: Floats, contenders: int) -> int:
    drawn = random.integers(0, len(costs), contenders)
    return int(drawn[np.argmin(costs[drawn])])


def mutate(random: Generator, people: Floats, settings: SearchSettings, space: Space) -> Flags:
    """Give random genes new values; those drawn among the elite keep theirs. Returns who changed."""
    changed = np.zeros(len(people), dtype=np.bool_)
    genes = people.shape[1]
    for _ in range(math.ceil((len(people) - 1) * genes * settings.mutation_rate)):
        person, gene = int(random.integers(1, len(people))), int(random.integers(0, genes))
        share = random.random()
        if person < settings.elite:
            continue
        low, high = _limits(people[person], gene, space)
        people[person, gene] = low + share * (high - low)
        changed[person] = True
    return changed


def _limits(person: Floats, gene: int, space: Space) -> tuple[float, float]:
    low, high = float(space.low[gene]), float(space.high[gene])
    for greater, smaller in space.ordered:
        if gene == smaller:
            high = min(high, max(low, float(person[greater])))
        elif gene == greater:
            low = max(low, min(high, float(person[smaller])))
    return low, high


def order_of(names: list[str]) -> tuple[tuple[int, int], ...]:
    """Return the pairs of (3.32) among parameters by name: slow above fast in resistance, inductance and constant."""
    pairs = ((f"slow_{part}", f"fast_{part}") for part in ("resistance_ohm", "inductance_henry", "constant_v_s"))
    return tuple((names.index(slow), names.index(fast)) for slow, fast in pairs if slow in names and fast in names)
