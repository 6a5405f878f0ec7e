"""Stage 2: the genetic algorithm keeps to 5.5 and Table 5-7, others find the same, a journal answers what it knows."""

import numpy as np
import pytest

from hilplant.failure import Failure
from hilplant.identify.genetic import SearchSettings, Space, first_population, genetic, mutate, offspring, order_of
from hilplant.identify.journal import Journal
from hilplant.identify.optimisers import OPTIMISERS, optimiser

SPACE = Space(np.array([0.5, 0.5, -1.0, 0.0]), np.array([2.0, 2.0, 1.0, 10.0]))
TARGET = np.array([1.2, 0.9, -0.3, 7.0])


def bowl(sets):
    return np.sum(((sets - TARGET) / (SPACE.high - SPACE.low)) ** 2, axis=1)


def test_the_settings_are_those_of_table_5_7():
    assert SearchSettings()[:5] == (40, 0.5, 5, 0.1, 200)


@pytest.mark.parametrize("name", OPTIMISERS)
def test_every_optimiser_comes_near_the_minimum_and_repeats_itself(name):
    settings = SearchSettings(generations=60)
    first, second = (optimiser(name)(bowl, SPACE, settings, 3, lambda _: None) for _ in range(2))
    assert first.cost < 2e-3
    assert bowl(first.values[np.newaxis])[0] == first.cost
    assert np.array_equal(first.values, second.values)
    assert [seen.best for seen in first.history] == sorted((seen.best for seen in first.history), reverse=True)
    assert first.history[-1].evaluations <= 40 * 61


def test_an_unknown_optimiser_is_refused_with_those_that_are_known():
    with pytest.raises(Failure, match="genetic, cma, de"):
        optimiser("gradient")


def test_only_individuals_that_changed_are_evaluated_again():
    """Survivors, and children that are like one, keep their costs: hardly anybody is evaluated twice."""
    asked = []

    def remember(sets):
        asked.append(sets.copy())
        return bowl(sets)

    genetic(remember, SPACE, SearchSettings(generations=20), 1)
    assert len(asked[0]) == 40
    assert all(10 <= len(sets) <= 35 for sets in asked[1:])
    everyone = np.vstack(asked)
    repeated = len(everyone) - len(np.unique(everyone, axis=0))
    assert repeated <= 2  # the same child twice at once


def test_children_lie_between_their_parents_as_5_27_and_5_28_say():
    """Each blended pair keeps the sum of its genes: rho_1 + rho_2 = ma + da, which Appendix E's misprint breaks."""
    random = np.random.default_rng(5)
    parents = np.array([SPACE.low, SPACE.high])
    costs = np.array([1.0, 1.0])
    children = offspring(random, parents, costs, SearchSettings(population=42), SPACE)
    total = children[0::2] + children[1::2]
    allowed = np.array([2.0 * SPACE.low, SPACE.low + SPACE.high, 2.0 * SPACE.high])
    assert all(np.min(np.max(np.abs(allowed - row), axis=1)) < 1e-12 for row in total)
    assert np.all(children >= SPACE.low - 1e-12)
    assert np.all(children <= SPACE.high + 1e-12)
    inside = (children > SPACE.low + 1e-9) & (children < SPACE.high - 1e-9)
    assert inside.any()


def test_the_elite_is_never_mutated_and_mutations_are_a_tenth_of_the_genes():
    random, settings = np.random.default_rng(2), SearchSettings()
    people = first_population(random, SPACE, 40)
    before = people.copy()
    changed = mutate(random, people, settings, SPACE)
    assert np.array_equal(people[:5], before[:5])
    assert np.array_equal(np.any(people != before, axis=1), changed)
    assert 6 <= np.count_nonzero(people != before) <= 16  # 39 x 4 x 0.1 = 16 draws, some on the elite


def test_slow_stays_above_fast_where_that_is_asked_for():
    names = ["slow_resistance_ohm", "fast_resistance_ohm", "slow_constant_v_s", "fast_constant_v_s"]
    low, high = np.full(4, 0.5), np.full(4, 2.0)
    space = Space(low, high, order_of(names))
    assert space.ordered == ((0, 1), (2, 3))
    seen = []

    def remember(sets):
        seen.append(sets.copy())
        return np.sum((sets - np.array([0.6, 1.9, 1.0, 1.0])) ** 2, axis=1)  # pulls against the order

    genetic(remember, space, SearchSettings(generations=15), 4)
    everyone = np.vstack(seen)
    assert np.all(everyone[:, 0] >= everyone[:, 1])
    assert np.all(everyone[:, 2] >= everyone[:, 3])


@pytest.mark.parametrize("name", OPTIMISERS)
def test_a_journal_cut_anywhere_leads_to_the_same_bits(name, tmp_path):
    """A run that dies after a few populations and goes on ends as one that was never disturbed."""
    settings, calls = SearchSettings(generations=12), []

    def dies_after(count):
        def evaluate(sets):
            if len(calls) == count:
                raise KeyboardInterrupt
            calls.append(len(sets))
            return bowl(sets)

        return evaluate

    whole = optimiser(name)(bowl, SPACE, settings, 9, lambda _: None)
    path = tmp_path / "run.journal"
    journal = Journal(path, "same", resume=False)
    with pytest.raises(KeyboardInterrupt):
        optimiser(name)(journal.answering(dies_after(5)), SPACE, settings, 9, lambda _: None)
    again = Journal(path, "same", resume=True)
    assert again.known == 5
    calls.clear()
    ended = optimiser(name)(again.answering(dies_after(-1)), SPACE, settings, 9, lambda _: None)
    assert np.array_equal(ended.values, whole.values)
    assert ended.history == whole.history
    assert len(calls) == len(whole.history) - 5


def test_a_journal_of_something_else_is_refused(tmp_path):
    path = tmp_path / "run.journal"
    Journal(path, "one", resume=False).answering(bowl)(np.ones((3, 4)))
    with pytest.raises(Failure, match="belongs to another identification"):
        Journal(path, "other", resume=True)
    with pytest.raises(Failure, match="does not fit what is asked now"):
        Journal(path, "one", resume=True).answering(bowl)(np.zeros((3, 4)))
    path.write_text("no journal")
    with pytest.raises(Failure, match="is no journal"):
        Journal(path, "one", resume=True)
