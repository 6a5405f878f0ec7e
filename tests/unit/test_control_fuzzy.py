"""The fuzzy system: what the thesis tells of its sets, and the table against a centroid taken here by itself."""

import numpy as np
import pytest

from hilplant.control.fuzzy_sets import ERROR_SETS, GAIN_SETS, RULES, degrees_of_membership, fuzzy_gain_at, gain_table
from hilplant.control.single_neuron import fuzzy_gain


def triangle(x: np.ndarray, corners: tuple[float, ...]) -> np.ndarray:
    left, peak, right = corners
    return np.clip(np.minimum((x - left) / (peak - left), (right - x) / (right - peak)), 0.0, 1.0)


def z_shape(x: np.ndarray, begin: float, end: float) -> np.ndarray:
    middle = 0.5 * (begin + end)
    width = end - begin
    falling = np.where(x < middle, 1.0 - 2.0 * ((x - begin) / width) ** 2, 2.0 * ((x - end) / width) ** 2)
    return np.where(x <= begin, 1.0, np.where(x >= end, 0.0, falling))


def centroid(error: float) -> float:
    """Mamdani's inference with a fine grid, without the library."""
    k, error = np.linspace(0.0, 1.0, 20_001), min(max(error, -3.0), 3.0)
    shapes = {n: z_shape(k, *c) if len(c) == 2 else triangle(k, c) for n, c in GAIN_SETS.items()}
    joined = np.zeros_like(k)
    for name, gain in RULES.items():
        mirrored = name.startswith("P")
        corners = ERROR_SETS[name.replace("P", "N") if mirrored else name]
        degree = float(triangle(np.array([-error if mirrored else error]), corners)[0])
        joined = np.maximum(joined, np.minimum(degree, shapes[gain]))
    return float((k * joined).sum() / joined.sum())


def test_at_minus_2_the_error_is_nb_to_an_eighth_and_nm_to_three_tenths():
    degrees = {name: float(degree[0]) for name, degree in degrees_of_membership(np.array([-2.0])).items()}
    assert degrees.pop("NB") == pytest.approx(0.125)
    assert degrees.pop("NM") == pytest.approx(0.3)
    assert set(degrees.values()) == {0.0}


def test_there_are_seven_input_sets_four_output_sets_and_seven_rules():
    assert len(degrees_of_membership(np.zeros(1))) == len(RULES) == 7
    assert set(RULES.values()) == set(GAIN_SETS) == {"VS", "S", "M", "B"}


@pytest.mark.parametrize("error", [-9.0, -3.0, -2.2, -2.0, -0.75, -0.2, 0.0, 0.05, 0.4, 0.9, 1.9, 2.5, 3.0, 40.0])
def test_k_is_the_centroid(error):
    assert fuzzy_gain_at(np.array([error]))[0] == pytest.approx(centroid(error), abs=2e-3)
    assert fuzzy_gain(error, gain_table()) == pytest.approx(centroid(error), abs=4e-3)


def test_k_is_the_same_for_both_signs_falls_with_the_error_and_stays_between_0_and_1():
    errors = np.linspace(0.0, 3.0, 301)
    gains = fuzzy_gain_at(errors)
    assert fuzzy_gain_at(-errors) == pytest.approx(gains)
    assert np.all(np.diff(gains) <= 1e-9)
    assert 0.0 < gains[-1] < 0.15
    assert 0.65 < gains[0] < 1.0
