"""Two evaluators that share no arithmetic, one over arrays and one tick by tick, give the same verdicts."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilplant.verdicts.arrays import Trace, judge
from hilplant.verdicts.expectations import (
    Comes,
    Count,
    Edge,
    Expectation,
    Holds,
    Level,
    Response,
    Settles,
    Stays,
    Window,
)
from hilplant.verdicts.ticks import LiveExpectation

TICKS = st.integers(0, 12)
VALUES = st.sampled_from([-1.0, 0.0, 0.25, 1.0, 2.0])
LEVELS = st.builds(Level, st.sampled_from("ab"), st.sampled_from([-np.inf, 0.0, 1.0]), st.sampled_from([1.0, np.inf]))
EDGES = st.builds(Edge, st.sampled_from("ab"), st.booleans(), st.sampled_from([0.5, 0.0]))
CONDITIONS = st.lists(LEVELS | EDGES, min_size=1, max_size=2).map(tuple)
STEPS = st.lists(TICKS | CONDITIONS, max_size=2).map(tuple)
RULES = st.one_of(
    st.builds(Holds, CONDITIONS, st.booleans()),
    st.builds(Comes, CONDITIONS, TICKS),
    st.builds(Settles, LEVELS, TICKS, st.none() | TICKS),
    st.builds(Stays, st.sampled_from("ab"), st.sampled_from([0.0, 0.5]), st.none() | TICKS),
    st.builds(Response, CONDITIONS, CONDITIONS, TICKS),
    st.builds(Count, CONDITIONS, st.integers(0, 3).map(float), st.integers(0, 3).map(float) | st.just(np.inf)),
)
WINDOWS = st.builds(Window, STEPS, STEPS, st.just(()) | LEVELS.map(lambda level: (level,)))


@st.composite
def traces(draw: st.DrawFn) -> Trace:
    count = draw(st.integers(1, 30))
    seen = np.array(draw(st.lists(st.sampled_from([True] * 15 + [False]), min_size=count, max_size=count)))
    signals = {}
    for name in "ab":
        values = np.array(draw(st.lists(VALUES, min_size=count, max_size=count)))
        values[: draw(st.sampled_from([0, 0, 3]))] = np.nan
        for tick in np.flatnonzero(~seen):
            values[tick] = values[tick - 1] if tick else np.nan
        signals[name] = values
    return Trace(0.001, signals, seen, {})


@settings(max_examples=400, deadline=None)
@given(RULES, WINDOWS, traces())
def test_a_run_judged_live_gets_the_verdict_of_the_whole_run(rule: object, window: Window, trace: Trace) -> None:
    expectation = Expectation(rule, window)  # type: ignore[arg-type]
    live = LiveExpectation(expectation)
    failed_early = False
    for tick in range(trace.ticks):
        live.take({name: float(values[tick]) for name, values in trace.signals.items()}, bool(trace.seen[tick]))
        failed_early = failed_early or live.failed
    whole, ended = judge(expectation, trace), live.end()
    assert (ended.ruling, ended.tick, ended.reason) == (whole.ruling, whole.tick, whole.reason)
    np.testing.assert_equal(ended.robustness, whole.robustness)
    if failed_early:
        assert whole.ruling == "fail"


def test_a_violation_is_known_in_its_own_tick() -> None:
    live = LiveExpectation(Expectation(Holds((Level("a", highest=25.0),)), Window(after=(2,))))
    for tick, value in enumerate([30.0, 30.0, 24.0, 26.0, 24.0]):
        live.take({"a": value})
        assert live.failed is (tick >= 3)
    assert live.end().robustness == pytest.approx(-1.0)
