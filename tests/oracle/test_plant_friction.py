"""(4.49), (4.50) and the tacky curve against the formulas, their slopes against differences, and what wetness mixes."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilplant.models.friction import coefficient
from hilplant.models.records import Friction
from hilplant.thesis.reference_equations import friction_coefficient

CURVE = Friction(
    0.3186, 0.1238, 1.996, 19.96, 0.4454, 4.454, 7.578e-3, 0.6756, 6.756, 2.795e-4, 3.456e-3, 2.4, 0.5, 0.6, 0.02
)
#: The four columns of Table 4-1, and the six rows of Table 4-2 with their force.
DRY = [(0.25, 0.1, 0.75, 7.5), (0.5, 0.1, 0.75, 7.5), (0.4, 0.3, 0.75, 7.5), (0.15, 0.05, 0.75, 7.5)]
WET = [
    ((0.6, 6.0, 0.01, 1.0, 10.0, 0.0002, 0.025), 10.0),
    ((1.0, 10.0, 0.01, 1.2, 12.0, 0.0002, 0.025), 10.0),
    ((0.6, 6.0, 0.01, 0.8, 8.0, 0.0005, 0.025), 10.0),
    ((0.6, 6.0, 0.05, 1.0, 10.0, 0.0002, 0.025), 10.0),
    ((0.6, 6.0, 0.05, 1.0, 10.0, 0.0002, 0.05), 10.0),
    ((0.6, 6.0, 0.01, 1.0, 10.0, 0.0002, 0.025), 15.0),
]
SPEEDS = st.floats(0.0, 5000.0) | st.floats(0.0, 1.0) | st.just(0.0)
FORCES = st.floats(0.0, 50.0)


@settings(deadline=None)
@given(velocity=SPEEDS, wetness=st.floats(0.0, 1.0), force=FORCES)
def test_the_coefficient_is_that_of_the_formulas(velocity: float, wetness: float, force: float) -> None:
    mu, _ = coefficient(velocity, wetness, force, CURVE)
    assert mu == pytest.approx(friction_coefficient(velocity, wetness, force, CURVE), rel=1e-12, abs=2e-15)


@pytest.mark.parametrize("row", DRY)
def test_dry_friction_levels_off_at_the_sum_of_its_two_terms(row: tuple[float, ...]) -> None:
    curve = Friction(*row)
    assert coefficient(1000.0, 0.0, 10.0, curve)[0] == pytest.approx(row[0] + row[2], rel=1e-12)
    assert coefficient(1.0, 0.0, 10.0, curve)[0] == pytest.approx(row[2] + row[0] * math.tanh(row[1]), rel=1e-5)


@pytest.mark.parametrize(("row", "force"), WET)
def test_wet_friction_peaks_and_then_falls(row: tuple[float, ...], force: float) -> None:
    curve = Friction(0.0, 0.0, 0.0, 0.0, *row)
    peak, slow, fast = (coefficient(v, 1.0, force, curve)[0] for v in (1.0, 100.0, 500.0))
    assert 0.0 < coefficient(0.01, 1.0, force, curve)[0] < peak
    assert peak > slow > fast > 0.0
    product = (row[6] * force + row[3]) * (row[0] + row[3] - row[0] * math.tanh(row[2]) - row[5])
    assert peak == pytest.approx(product, rel=1e-3)


@settings(deadline=None)
@given(velocity=st.floats(0.1, 990.0), wetness=st.floats(0.0, 1.0), force=FORCES)
def test_the_slope_is_the_derivative(velocity: float, wetness: float, force: float) -> None:
    width = 1e-4 * min(1.0, velocity)
    above, below = (coefficient(velocity + side, wetness, force, CURVE)[0] for side in (width, -width))
    slope = coefficient(velocity, wetness, force, CURVE)[1]
    assert slope == pytest.approx((above - below) / (2.0 * width), rel=1e-4, abs=1e-8)


def test_beyond_the_limit_the_coefficient_stays_and_nothing_is_ever_negative() -> None:
    short = CURVE._replace(velocity_limit_mm_s=300.0)
    assert coefficient(3000.0, 1.0, 7.6, short) == (coefficient(300.0, 1.0, 7.6, short)[0], 0.0)
    endless = CURVE._replace(velocity_limit_mm_s=math.inf)
    assert coefficient(1e5, 1.0, 7.6, endless) == (0.0, 0.0)
    assert coefficient(1e5, 0.75, 7.6, endless)[0] == pytest.approx(0.5 * CURVE.tacky_1)
    # a blade pressed so hard that a negative mu_wet_7 takes all friction does not rub again beyond the data
    weakened = endless._replace(wet_7=-0.1)
    assert [coefficient(velocity, 1.0, 20.0, weakened) for velocity in (100.0, 1e5)] == [(0.0, 0.0), (0.0, 0.0)]


def test_a_tacky_screen_rubs_most_and_a_wet_one_least() -> None:
    for velocity in (10.0, 100.0, 300.0, 1000.0):
        dry, tacky, wet = (coefficient(velocity, water, 7.615, CURVE)[0] for water in (0.0, 0.5, 1.0))
        assert tacky > dry > wet
        assert coefficient(velocity, 0.25, 7.615, CURVE)[0] == pytest.approx(0.5 * (dry + tacky))
        assert coefficient(velocity, 0.9, 7.615, CURVE)[0] == pytest.approx(0.2 * tacky + 0.8 * wet)
