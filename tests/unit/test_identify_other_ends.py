"""What two starts of stage 3 say together: the better end, widened by another where the data allow that as well."""

from types import SimpleNamespace

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.identify.local_search import SUREST, Solution
from hilplant.identify.other_ends import with_other_ends
from hilplant.identify.parameters import chosen, search_space
from hilplant.identify.profile import ConfidenceInterval
from hilplant.identify.uncertainty import Identifiability, Spread

COUNT = 1000
NAMES = ("slow_resistance_ohm", "mu_dry_2")


class Problem:
    """Residuals of size 1, which rise by what `rises` says of mu_dry_2; `noise_a` is the current's restlessness."""

    def __init__(self, choice, rises, noise_a=0.1):
        self.choice, self.parameters = choice, len(choice)
        self.scale, self.noise = np.ones(len(choice)), SimpleNamespace(current_a=noise_a)
        current = np.random.default_rng(5).normal(0.0, noise_a, COUNT)
        self.runs = [SimpleNamespace(current_a=current, valid=np.ones(COUNT, bool), period_s=1e-3)]
        self._rises = rises

    def residuals(self, x):
        return np.full(COUNT, np.sqrt(1.0 + self._rises(x[1]) / COUNT))

    def values(self, x):
        return x


def solution_at(problem, value):
    """Return a solution that ended with this mu_dry_2."""
    x = np.array([1.2, value])
    return Solution(x, problem, problem.residuals(x), np.eye(COUNT, 2), 0, x, x, (), True)


@pytest.fixture(scope="module")
def choice():
    row = load_bench("default").parameter_row
    return chosen(row, held=[each for each in chosen(row).names if each not in NAMES])


def said(choice, values, half):
    """Return verdicts and intervals about the values."""
    pairs = zip(choice.names, values, strict=True)
    verdicts = [Identifiability(name, value, half / 2, True, ()) for name, value in pairs]
    return verdicts, [ConfidenceInterval(value - half, value + half) for value in values]


KNOWN = Spread(np.eye(2), np.ones(2))


@pytest.mark.parametrize(
    ("rise", "other", "low", "identifiable"),
    [
        (50.0, 0.130, 0.136, True),  # worse than the data allow: it says nothing
        (2.0, 0.130, 0.130, True),  # as good: the interval reaches to it
        (2.0, 0.600, None, False),  # as good and far away: nothing is told
    ],
)
def test_another_end_counts_where_the_data_allow_it(choice, rise, other, low, identifiable):
    """3.84 is what the sum of squares may rise by for 95 % (chi-square of one degree of freedom)."""
    problem = Problem(choice, lambda value: 0.0 if abs(value - 0.137) < 1e-9 else rise)
    best, another = solution_at(problem, 0.137), solution_at(problem, other)
    verdicts, intervals = with_other_ends(best, [another], KNOWN, said(choice, best.values, 1e-3))
    assert verdicts[1].identifiable == identifiable
    assert intervals[1].low == (pytest.approx(low) if low is not None else None)
    assert verdicts[0].identifiable
    assert intervals[0] == pytest.approx((1.199, 1.201))


def test_the_space_is_that_of_equation_5_22(choice):
    """The case of 0.6 above is beyond half of the space about 0.137; that of 0.13 is not."""
    low, high = search_space(choice, np.array([1.2, 0.137]))
    assert 0.007 < 0.5 * (high[1] - low[1]) < 0.6 - 0.137


def test_data_without_noise_say_no_more_than_the_surest_current(choice):
    """Simulated data leave nothing over; an interval of no width would be told."""
    problem = Problem(choice, lambda value: -0.9999 * COUNT)
    exact = solution_at(problem, 0.137)
    assert np.mean(exact.residuals**2) < 1e-3
    assert exact.variance == pytest.approx(SUREST**2, rel=0.25)  # the restlessness is an estimate, from 1000 samples
