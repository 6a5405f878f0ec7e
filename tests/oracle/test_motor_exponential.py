"""The closed-form matrix exponential against scipy's, over real, equal and complex eigenvalues."""

import math
from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from hilplant.models.armature import ArmatureDrive, ArmatureMotion, coast, glide, propagator


def powers_of_ten(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


MOTORS = st.builds(
    ArmatureDrive,
    voltage=st.floats(-40.0, 40.0),
    resistance=powers_of_ten(-1, 1.5),
    inductance=powers_of_ten(-5, -1.5),
    constant=powers_of_ten(-4, 0),
    inertia=powers_of_ten(-9, -3),
    damping=powers_of_ten(-7, 0) | st.just(0.0),
    dry_torque=st.just(0.0),
    push=st.just(0.0) | st.floats(-1.0, 1.0),
)


def scaled_error(drive: ArmatureDrive, time: float) -> float:
    """Compare in coordinates sqrt(L) i, sqrt(J) w, in which exp(A t) never exceeds 1 and scipy's is well scaled."""
    coupling = drive.constant / math.sqrt(drive.inductance * drive.inertia)
    a = np.array([[-drive.resistance / drive.inductance, -coupling], [coupling, -drive.damping / drive.inertia]])
    scale = math.sqrt(drive.inertia / drive.inductance)
    e11, e12, e21, e22 = propagator(drive, time)
    return float(np.abs(np.array([[e11, e12 / scale], [e21 * scale, e22]]) - expm(a * time)).max())


@settings(max_examples=200, deadline=None)
@given(drive=MOTORS, time=powers_of_ten(-7, -2))
def test_the_closed_form_is_scipys_exponential(drive: ArmatureDrive, time: float) -> None:
    rates = drive.resistance / drive.inductance + drive.damping / drive.inertia
    rates += drive.constant / math.sqrt(drive.inductance * drive.inertia)
    # scipy gets there by squaring, and its rounding grows with the norm
    assert scaled_error(drive, time) < 1e-12 + 5e-14 * rates * time


@pytest.mark.parametrize("nudge", [0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-8, -1e-8, 1e-4, -1e-4])
def test_nothing_is_lost_where_the_eigenvalues_come_together(nudge: float) -> None:
    # half the difference of the diagonal, 200 1/s, equals the coupling, 200 1/s
    drive = ArmatureDrive(0.0, 0.4, 1e-3, 200.0 * math.sqrt(1e-8) * (1.0 + nudge), 1e-5, 0.0, 0.0)
    assert scaled_error(drive, 1e-3) < 1e-14


def test_the_stiffest_motors_neither_overflow_nor_lose_their_slow_part() -> None:
    drive = ArmatureDrive(0.0, 1.0, 1e-2, 1e-3, 1e-9, 1.0, 0.0)
    e11, e12, e21, e22 = propagator(drive, 1e-3)
    assert all(math.isfinite(element) for element in (e11, e12, e21, e22))
    assert math.isclose(e11, math.exp(-100.0 * 1e-3), rel_tol=1e-6)
    assert abs(e22) < 1e-8


@settings(max_examples=100, deadline=None)
@given(drive=MOTORS, current=st.floats(-50, 50), speed=st.floats(-400, 400), torque=st.floats(-1, 1))
def test_the_turned_angle_is_the_integral_of_the_speed(
    drive: ArmatureDrive, current: float, speed: float, torque: float
) -> None:
    # Gauss-Legendre quadrature of the speed over a time in which nothing happens fast
    rates = drive.resistance / drive.inductance + drive.damping / drive.inertia
    rates += drive.constant / math.sqrt(drive.inductance * drive.inertia)
    time = 1.0 / rates
    nodes, weights = np.polynomial.legendre.leggauss(12)
    start = ArmatureMotion(current, speed, 0.0)
    speeds = [glide(start, drive, torque, 0.5 * time * (node + 1.0)).speed for node in nodes]
    # the angle comes from differences of the speed, times the mechanical time constant
    strength = drive.resistance * drive.damping + drive.constant**2
    final = (abs(drive.voltage) * drive.constant + drive.resistance * (abs(torque) + abs(drive.push))) / strength
    lost = 1e-14 * (final + abs(speed)) * (time + drive.resistance * drive.inertia / strength)
    turned = 0.5 * time * float(weights @ speeds)
    assert abs(glide(start, drive, torque, time).turned - turned) <= 1e-8 * time * np.abs(speeds).max() + lost


@pytest.mark.parametrize("x", [0.0, 1e-12, 1e-6, 3e-4, 9.99e-4, 1.001e-3, 0.1, 3.0])
def test_an_open_armature_coasts_as_the_exponential_of_fifty_digits(x: float) -> None:
    """Damping from none to strong, on both sides of where the series is left."""
    time, inertia, speed, torque = 1e-3, 2e-5, 300.0, 0.01
    drive = ArmatureDrive(12.0, 1.0, 1e-3, 0.0, inertia, x * inertia / time, 0.0)
    with localcontext(prec=50):
        exact = Decimal(drive.damping) * Decimal(time) / Decimal(inertia)
        first = (1 - (-exact).exp()) / exact if exact else Decimal(1)
        second = (1 - first) / exact if exact else Decimal("0.5")
        change = -(Decimal(drive.damping) * Decimal(speed) + Decimal(torque)) / Decimal(inertia) * Decimal(time)
        wanted = float(Decimal(speed) + change * first), float(Decimal(time) * (Decimal(speed) + change * second))
    assert coast(ArmatureMotion(5.0, speed, 0.0), drive, torque, time) == pytest.approx((0.0, *wanted), rel=1e-13)
