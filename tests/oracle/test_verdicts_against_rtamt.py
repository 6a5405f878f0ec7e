"""Robustness against rtamt, a library for signal temporal logic that is written apart from this project."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilplant.verdicts.arrays import Trace, judge
from hilplant.verdicts.expectations import Comes, Expectation, Holds, Level, Response, Rule, Settles

rtamt = pytest.importorskip("rtamt", reason="rtamt needs Python before 3.13")

TICKS = 40
NUMBERS = st.floats(-10.0, 10.0, allow_nan=False).map(lambda value: round(value, 3))
RUNS = st.lists(NUMBERS, min_size=TICKS, max_size=TICKS).map(np.array)
DELAYS = st.integers(0, 15)


def oracle(formula: str, a: np.ndarray, b: np.ndarray) -> float:
    """Robustness of a formula at the first tick."""
    specification = rtamt.StlDiscreteTimeSpecification()
    for name in "ab":
        specification.declare_var(name, "float")
    specification.spec = formula
    specification.parse()
    result = specification.evaluate({"time": list(range(len(a))), "a": a.tolist(), "b": b.tolist()})
    return float(result[0][1])


def ours(rule: Rule, a: np.ndarray, b: np.ndarray) -> float:
    trace = Trace(0.001, {"a": a, "b": b}, np.ones(len(a), np.bool_), {})
    judgement = judge(Expectation(rule), trace)
    assert judgement.ruling == ("pass" if judgement.robustness >= 0.0 else "fail")
    return judgement.robustness


@settings(max_examples=25, deadline=None)
@given(RUNS, RUNS, NUMBERS)
def test_always_and_never(a: np.ndarray, b: np.ndarray, limit: float) -> None:
    below, above = Level("a", highest=limit), Level("b", lowest=limit)
    both = f"(a <= {limit}) and (b >= {limit})"
    assert ours(Holds((below, above)), a, b) == pytest.approx(oracle(f"always({both})", a, b), abs=1e-12)
    margin = oracle(f"always(not ({both}))", a, b)
    if margin != 0.0:  # at the limit itself a condition holds, so that never is violated
        assert ours(Holds((below, above), never=True), a, b) == pytest.approx(margin, abs=1e-12)


@settings(max_examples=25, deadline=None)
@given(RUNS, RUNS, NUMBERS, DELAYS)
def test_within(a: np.ndarray, b: np.ndarray, limit: float, delay: int) -> None:
    rule = Comes((Level("a", highest=limit),), delay)
    assert ours(rule, a, b) == pytest.approx(oracle(f"eventually[0,{delay}](a <= {limit})", a, b), abs=1e-12)


@settings(max_examples=25, deadline=None)
@given(RUNS, RUNS, NUMBERS, DELAYS, DELAYS)
def test_settles(a: np.ndarray, b: np.ndarray, target: float, by: int, hold: int) -> None:
    rule = Settles(Level("a", target - 2.0, target + 2.0), by, hold)
    inside = f"(a >= {target - 2.0!r}) and (a <= {target + 2.0!r})"
    formula = f"eventually[0,{by}](always[0,{hold}]({inside}))"
    assert ours(rule, a, b) == pytest.approx(oracle(formula, a, b), abs=1e-12)


@settings(max_examples=25, deadline=None)
@given(RUNS, RUNS, NUMBERS, DELAYS)
def test_response(a: np.ndarray, b: np.ndarray, limit: float, delay: int) -> None:
    """The trigger is a flag, which rtamt sees as a number far from its limit: only its own ticks decide."""
    flag = np.where(a > 5.0, 1000.0, -1000.0)
    flag[-delay - 1 :] = -1000.0  # so that every trigger has its time
    flag[1:][flag[:-1] > 0.0] = -1000.0  # each is a tick of its own
    begins = np.flatnonzero((flag > 0.0) & ~np.append(False, flag[:-1] > 0.0))
    if not len(begins):
        return
    expected = oracle(f"always((a >= 0.0) implies (eventually[0,{delay}](b >= {limit})))", flag, b)
    rule = Response((Level("a", lowest=0.0),), (Level("b", lowest=limit),), delay)
    assert ours(rule, flag, b) == pytest.approx(expected, abs=1e-12)
