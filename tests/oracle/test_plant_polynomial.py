"""(6.1)-(6.3) against exact rational arithmetic, and the table look-up against the function it samples."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilplant.models.load import LOADS, by_speed
from hilplant.models.lookup import derivative, find, value
from hilplant.models.polynomial import C1, C2, forward_shape, reverse_shape
from hilplant.models.records import NO_NETWORKS, Load
from hilplant.signals import Inputs

#: Coefficients as printed, highest power first.
F = ("-0.19224", "0.021769", "-0.15435", "0.077812", "0.68626")
G = ("0.4184", "-0.30315", "-0.42441", "0.12634", "0.21484", "-0.10093", "-0.29859", "0.63276")
POLYNOMIAL = Load(float(LOADS.index("polynomial")), C1, C2)
FREE = Inputs(1.0, 0.0, 13.5, 0.0, 0.0, 0.0)


def load_damping(angle: float, speed: float, load: Load) -> float:
    return by_speed(angle, speed, load, FREE, NO_NETWORKS).slope


def load_torque(angle: float, speed: float, load: Load) -> float:
    held = by_speed(angle, speed, load, FREE, NO_NETWORKS)
    assert (held.inertia, held.bias, held.dry) == (0.0, 0.0, 0.0)
    return held.slope * abs(speed)


def exact(coefficients: tuple[str, ...], x: float) -> float:
    powers = range(len(coefficients) - 1, -1, -1)
    return float(sum(Fraction(c) * Fraction(x) ** power for c, power in zip(coefficients, powers, strict=True)))


@settings(deadline=None)
@given(st.floats(-1.0, 1.0))
def test_both_shapes_are_as_printed_to_rounding(x: float) -> None:
    assert forward_shape(x) == pytest.approx(exact(F, x), rel=5e-16, abs=5e-16)
    assert reverse_shape(x) == pytest.approx(exact(G, x), rel=5e-16, abs=5e-16)


@settings(deadline=None)
@given(st.floats(0.0, 2.0 * math.pi), st.floats(0.0, 20.0))
def test_the_torque_is_that_of_6_3(angle: float, speed: float) -> None:
    x = math.sin(angle)
    shape = exact(F if x >= 0.0 else G, x)
    assert load_torque(angle, speed, POLYNOMIAL) == pytest.approx(
        speed * 0.2738 * (shape + speed * 0.0035), rel=4e-15, abs=1e-300
    )


def test_the_shapes_meet_their_printed_values_where_the_sine_changes_sign() -> None:
    assert load_damping(0.0, 0.0, POLYNOMIAL) == C2 * 0.68626
    assert load_damping(math.nextafter(math.pi, 4.0) + 1e-12, 0.0, POLYNOMIAL) == pytest.approx(C2 * 0.63276)


@settings(deadline=None)
@given(st.floats(0.0, 2.0 * math.pi), st.floats(-2000.0, 2000.0))
def test_no_load_ever_drives_the_motor(angle: float, speed: float) -> None:
    assert load_damping(angle, speed, POLYNOMIAL) >= 0.0
    assert load_torque(angle, speed, POLYNOMIAL) >= 0.0
    assert load_torque(angle, speed, Load(0.0, C1, C2)) == 0.0


def sine_table(knots: int) -> np.ndarray:
    angle = np.linspace(0.0, 2.0 * math.pi, knots + 1)
    return np.ascontiguousarray(np.stack([np.stack([np.sin(angle), np.cos(angle)], axis=1)] * 2, axis=1))


def hermite(table: np.ndarray, channel: int, angle: float) -> tuple[float, float]:
    place = find(table, angle)
    return value(table, place, channel), derivative(table, place, channel)


@settings(deadline=None)
@given(st.floats(0.0, 2.0 * math.pi, exclude_max=True))
def test_the_look_up_errs_by_no_more_than_the_bound_of_cubic_hermite_interpolation(angle: float) -> None:
    width = 2.0 * math.pi / 360
    height, slope = hermite(sine_table(360), 1, angle)
    assert abs(height - math.sin(angle)) <= width**4 / 384 + 1e-15
    assert abs(slope - math.cos(angle)) <= width**3 / 72 + 1e-13


def test_the_look_up_returns_its_knots_and_survives_what_is_no_angle() -> None:
    table = sine_table(64)
    for index in range(64):
        assert hermite(table, 0, index * 2.0 * math.pi / 64)[0] == pytest.approx(table[index, 0, 0], abs=1e-15)
    for wrong in (math.nan, math.inf, -math.inf, -1.0, 1e300):
        assert hermite(table, 0, wrong)[0] == table[0, 0, 0]
