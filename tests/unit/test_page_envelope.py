"""What a chart is shown keeps every signal's least and greatest value, whatever pieces the rows come in."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilplant.operator_page.blocks import HEAD, STRETCH, block
from hilplant.operator_page.envelope import Envelope, of_points


def rows(count: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    ticks = np.arange(17.0, 17.0 + count)
    return ticks, ticks * 0.001, np.random.default_rng(seed).normal(size=(count, 3))


@given(
    every=st.integers(3, 40),
    cuts=st.lists(st.integers(0, 400), max_size=12),
    seed=st.integers(0, 1000),
)
def test_in_whatever_pieces_they_come_the_extremes_of_each_group_are_there(
    every: int, cuts: list[int], seed: int
) -> None:
    ticks, times, values = rows(400, seed)
    envelope, shown_times, shown = Envelope(every), [], []
    bounds = [0, *sorted(cuts), 400]
    for first, last in pairwise(bounds):
        found = envelope.add(ticks[first:last], times[first:last], values[first:last])
        shown_times.append(found[0])
        shown.append(found[1])
    all_shown, all_times = np.vstack(shown), np.concatenate(shown_times)
    assert (np.diff(all_times) >= 0.0).all()
    groups = np.unique(ticks // every)[:-1]  # the last one waits for its end
    assert len(all_shown) == 2 * len(groups)
    for index, group in enumerate(groups):
        inside = values[ticks // every == group]
        pair = all_shown[2 * index : 2 * index + 2]
        assert (pair.min(axis=0) == inside.min(axis=0)).all()
        assert (pair.max(axis=0) == inside.max(axis=0)).all()


@pytest.mark.parametrize("every", [1, 2])
def test_little_thinning_is_none(every: int) -> None:
    ticks, times, values = rows(50, 0)
    found = Envelope(every).add(ticks, times, values)
    assert (found[0] == times).all() and (found[1] == values).all()


def test_a_single_tick_of_a_flag_is_never_thinned_away() -> None:
    ticks, times, values = rows(60_000, 0)
    values[:] = 0.0
    values[31_234, 1] = 1.0
    found = of_points(ticks, times, values, 2000)
    assert len(found[0]) <= 2100
    assert found[1].max(axis=0).tolist() == [0.0, 1.0, 0.0]


def test_a_block_is_head_row_times_and_each_signals_values() -> None:
    points = np.array([1.0, 2.0]), np.array([[10.0, 20.0], [11.0, 21.0]])
    data = np.frombuffer(block(STRETCH, 7, points, np.array([5.0, 6.0]), wall_ms=3.0, lost=4.0), "<f8")
    assert data[:HEAD].tolist() == [2.0, 7.0, 3.0, 2.0, 2.0, 4.0, 2.0, 0.0]
    assert data[HEAD:].tolist() == [5.0, 6.0, 1.0, 2.0, 10.0, 11.0, 20.0, 21.0]
