"""What the twin experiment makes of its trials, and when it says no."""

import pytest

from hilplant.identify.profile import ConfidenceInterval
from hilplant.thesis.coverage import Trial, coverage, holds
from hilplant.thesis.twin_study import reached


def test_trials_are_counted_and_their_errors_averaged():
    """Errors of 1 and -3 standard errors: mean -1, deviation 2; what is not told is inside nothing."""
    found = coverage([
        Trial(0, {"r": True, "f": False}, {"r": True, "f": False}, {"r": 1.0, "f": 0.1}),
        Trial(1, {"r": True, "f": False}, {"r": False, "f": False}, {"r": -3.0, "f": 0.1}),
    ])  # fmt: skip
    assert (found.trials, found.told, found.inside) == (2, {"r": 2, "f": 0}, {"r": 1, "f": 0})
    assert (found.mean["r"], found.deviation["r"]) == pytest.approx((-1.0, 2.0))


def test_an_open_side_holds_everything():
    assert holds(ConfidenceInterval(None, 2.0), 1.0)
    assert holds(ConfidenceInterval(0.5, None), 1.0)
    assert not holds(ConfidenceInterval(None, 0.5), 1.0)
    assert not holds(ConfidenceInterval(1.5, 2.0), 1.0)


GOOD = {
    "held_out_ratio": 1.19, "worst_r_k_part": 0.029, "full_inside": 36, "full_told": 40, "worst_inside": 90,
    "worst_told": 100,
}  # fmt: skip


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("held_out_ratio", 1.21),
        ("worst_r_k_part", 0.031),
        ("full_inside", 35),
        ("full_told", 0),
        ("worst_inside", 89),
        ("worst_told", 0),
    ],
)
def test_the_experiment_says_no_when_one_figure_is_worse(key, value):
    assert reached(GOOD)
    assert not reached(GOOD | {key: value})


def test_one_of_few_intervals_may_miss_by_chance():
    assert reached({"worst_inside": 2, "worst_told": 3})
    assert not reached({"worst_inside": 1, "worst_told": 3})
