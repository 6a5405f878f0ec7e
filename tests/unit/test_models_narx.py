"""The limits within which a network was trained, and the margin that a motor must keep from them to come back."""

import math

import numpy as np
import pytest

from hilplant.models.narx import TORQUE_ROUNDING_N_M, inside


@pytest.mark.parametrize(
    ("low", "high", "margin", "lowest", "highest"),
    [
        (2.0, 10.0, 0.0, 2.0, 10.0),
        (2.0, 10.0, 0.05, 2.4, 9.6),
        (-0.5, 0.0, 0.1, -0.45, -0.05),
        (0.0, 4.0, 0.25, -TORQUE_ROUNDING_N_M, 3.0),  # no margin where nothing is less
    ],
)
def test_a_number_is_inside_up_to_its_limits_less_the_margin_of_their_distance(
    low: float, high: float, margin: float, lowest: float, highest: float
) -> None:
    limits = np.array([math.nan, low, math.nan, math.nan, math.nan, high])
    hair = 1e-12
    assert [inside(limits, 1, number, margin) for number in (lowest - 10 * hair, lowest + hair)] == [False, True]
    assert [inside(limits, 1, number, margin) for number in (highest - hair, highest + hair)] == [True, False]
    assert not inside(limits, 1, math.nan, margin)
