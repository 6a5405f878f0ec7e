"""The test of 7.2 under the PID of Table 7-1, written down once more: motor, worm, wiper, friction and controller.

The controller is (7.1) in continuous time, the rest ordinary differential equations for an adaptive solver. Of the
project it takes the tables over the crank angle alone, which have oracles of their own.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline

from hilplant.bench import load_bench
from hilplant.control.catalogue import controller_named
from hilplant.models.tables import GRAVITY, INERTIA, POINTS
from hilplant.thesis.control_test import metrics, run_drive, thesis_drive
from hilplant.units import TURN_RAD

BENCH = load_bench("default")
MOTOR = BENCH.parameters.motor
PROPORTIONAL, INTEGRAL = 0.00177, 35.452
#: Table 7-3: end [s], reference over pi, dry.
STATES = ((5.0, 1.0, False), (10.0, 1.0, True), (12.0, 1.2, True), (15.0, 1.2, False), (20.0, 0.8, False))


class Wiper:
    """The wiper of Table 5-9 with its controller; the state is current, motor speed, crank angle, integral."""

    def __init__(self) -> None:
        knots = np.linspace(0.0, TURN_RAD, len(BENCH.tables))
        splines = [CubicHermiteSpline(knots, *BENCH.tables[:, c].T) for c in (INERTIA, GRAVITY, POINTS, POINTS + 1)]
        self.inertia, self.gravity, *self.ways = splines
        self.slope = self.inertia.derivative()

    def friction(self, angle: float, speed: float, dry: bool) -> float:
        """Friction of both blades at the crank by (4.49), (4.50), Table 5-9, straight from the paper."""
        total = 0.0
        for way in (abs(float(spline(angle))) for spline in self.ways):
            v = min(way * max(speed, 0.005) * 1000.0, 1000.0)
            if dry:
                mu = 0.3186 * math.tanh(0.1238 * v) + 1.996 * math.tanh(19.96 * v)
            else:
                bracket = 0.4454 * (math.tanh(4.454 * v) - math.tanh(0.007578 * v)) + 0.6756 * math.tanh(6.756 * v)
                mu = (0.003456 * 7.615 + 0.6756) * (bracket - 2.795e-4 * v)
            total += way * 7.615 * max(0.0, mu)
        return total

    def rates(self, _: float, x: list[float], reference: float, dry: bool) -> list[float]:
        """Return the derivatives; the worm passes no torque while the load would drive, and holds what stands."""
        current, w, angle, integral = x
        speed, at = w / 63.0, angle % TURN_RAD
        error = reference - speed
        wanted = PROPORTIONAL * error + integral
        held = (wanted >= 20.0 and error > 0.0) or (wanted <= 0.0 and error < 0.0)
        inertia = float(self.inertia(at))
        load = 0.5 * float(self.slope(at)) * speed**2 + float(self.gravity(at)) + self.friction(at, speed, dry)
        free = 4.579e-2 * current - 1.582e-4 * w
        rise = (free - load / 63.0) / (1.983e-5 + inertia / 63.0**2)
        if inertia * rise / 63.0 + load < 0.0:
            rise = free / 1.983e-5
        if w <= 0.0:
            rise = max(rise, 0.0)
        voltage = min(max(wanted, 0.0), 20.0)
        return [(voltage - 1.237 * current - 4.579e-2 * w) / 3.148e-3, rise, speed, 0.0 if held else INTEGRAL * error]


def test_every_figure_of_the_pid_is_the_same_by_an_adaptive_solver():
    wiper, state, begin, low, high, rise_s = Wiper(), [0.0, 0.0, 0.65, 0.0], 0.0, [], [], None
    for end, factor, dry in STATES:
        times = np.arange(begin, end + 1e-9, 0.001)
        options = {"args": (factor * math.pi, dry), "max_step": 0.002, "rtol": 1e-7}
        found = solve_ivp(wiper.rates, (begin, times[-1]), state, "LSODA", times, **options)
        error = found.y[1] / 63.0 - factor * math.pi
        rise_s = times[np.argmax(error >= 0.0)] if rise_s is None else rise_s
        low.append(-error[500:-1].min())
        high.append(error[500:-1].max())
        state, begin = found.y[:, -1], end
    ours = metrics(run_drive(BENCH, controller_named("pid", MOTOR, 0.001), thesis_drive(BENCH)))
    print(f"rise {rise_s:.3f} s, below {np.round(low, 3)}, above {np.round(high, 3)}")
    assert ours.rise_s == pytest.approx(rise_s, abs=0.002)
    assert ours.low == pytest.approx(low, abs=0.002)
    assert ours.high == pytest.approx(high, abs=0.002)


def test_pid_without_gravity_comes_to_the_figures_of_an_independent_rebuild():
    """Rise 0.69 s from park; errors 0.14/0.14, 0.44/0.82, 0.50/0.59, 0.20/0.22, 0.10/0.08 below/above."""
    tables = BENCH.tables.copy()
    tables[:, GRAVITY] = 0.0
    bench = replace(BENCH, tables=tables)
    run = run_drive(bench, controller_named("pid", MOTOR, 0.001), thesis_drive(bench, 0.0))
    found = metrics(run, settling_s=1.0)
    assert found.rise_s == pytest.approx(0.69, abs=0.01)
    assert found.low == pytest.approx((0.14, 0.44, 0.50, 0.20, 0.10), abs=0.02)
    assert found.high == pytest.approx((0.14, 0.82, 0.59, 0.22, 0.08), abs=0.025)
