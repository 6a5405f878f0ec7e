"""The two mechanical park sequences against an adaptive solver that finds every switching instant by itself.

Scipy integrates (3.30), (3.31) stretch by stretch. A stretch ends where the driver switches or where the cam does,
which an event of the solver locates; the plant sees the cam once in a tick. So the difference is mostly the error of
switching up to 1 ms late. Beside that, what a stop on paper comes to.
"""

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from hilplant.models.plant import simulate_rows
from hilplant.models.records import Arm, Brush, Load, Motor, Parameters, ParkSwitch, State
from hilplant.models.row import pack
from hilplant.models.tables import POINTS
from hilplant.signals import OUTPUTS, Inputs, Outputs
from hilplant.units import TURN_RAD

TABLE_5_9 = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.0, 63.0)
TABLE_5_6 = Motor(Brush(1.1704, 1.9e-3, 4.42e-2), Brush(0.7005, 4.0e-3, 3.21e-2), 1.9967e-5, 1.084e-4, 0.0, 63.0)
HALF_WINDOW, REVERSE = math.radians(7.0), 0.2
SUPPLY, SECONDS, STEP = 13.5, 8.0, 1e-3
MECHANICAL, DEPRESSED = 1.0, 2.0
LIMIT = 0.005  # of a signal's range, RMS

Column = NDArray[np.float64]


def plant(motor: Motor, circuit: float) -> tuple[Column, Column, Column]:
    """Return current, speed and crank angle of slow (0 s), fast (2 s), off (4 s), the angle without its turns."""
    switch = ParkSwitch(0.0, HALF_WINDOW, 0.0, 0.0, circuit, REVERSE)
    parameters = Parameters(STEP, motor, switch, Load(0.0), Arm(0.0, 0.5), Arm(0.0, 0.5))
    time = np.arange(round(SECONDS / STEP)) * STEP
    inputs = np.tile(pack(Inputs(1.0, 0.0, SUPPLY, 0.0, 0.0, 0.0)), (len(time), 1))
    inputs[:, 0], inputs[:, 1] = time < 4.0, (time >= 2.0) & (time < 4.0)
    outputs = np.empty((len(time), len(OUTPUTS)))
    state = pack(State(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0))
    simulate_rows(state, inputs, pack(parameters), np.zeros((9, POINTS + 2, 2)), outputs)
    seen = Outputs(*outputs.T)
    current, speed, angle = (
        np.asarray(column) for column in (seen.current_a, seen.motor_speed_rad_s, seen.crank_angle_rad)
    )
    return current, speed, np.unwrap(angle)


class Stretches:
    """An integration that goes on stretch by stretch, and the samples of all of them at the ticks."""

    def __init__(self, motor: Motor) -> None:
        self.motor, self.time = motor, 0.0
        self.state = np.zeros(3)  # current, speed, crank angle
        self.samples: list[Column] = []

    def go(
        self, brush: Brush | None, volts: float, until_s: float, stop: Callable[[Column], float] | None = None
    ) -> None:
        """Go on to a time, or to where `stop` comes to zero; without a brush the armature is open."""
        ticks = np.arange(math.ceil(self.time / STEP - 1e-9), round(until_s / STEP)) * STEP
        if brush is None:
            self.state[0] = 0.0
        events = [lambda t, x: stop(x)] if stop else None
        if events:
            events[0].terminal = True  # type: ignore[attr-defined]
        span = (self.time, until_s)
        found = solve_ivp(lambda t, x: self.rates(x, brush, volts), span, self.state, "Radau", ticks, False, events,
                          rtol=1e-10, atol=1e-10)  # fmt: skip
        self.samples.append(found.y)
        if found.status == 1:
            self.time, self.state = found.t_events[0][0], found.y_events[0][0]
        else:
            end = solve_ivp(lambda t, x: self.rates(x, brush, volts), span, self.state, "Radau", rtol=1e-10, atol=1e-10)
            self.time, self.state = until_s, end.y[:, -1]

    def rates(self, state: Column, brush: Brush | None, volts: float) -> Column:
        current, speed, _ = state
        motor, rate, torque = self.motor, 0.0, 0.0
        if brush is not None:
            rate = (volts - brush.resistance_ohm * current - brush.constant_v_s * speed) / brush.inductance_henry
            torque = brush.constant_v_s * current
        acceleration = (torque - motor.damping_n_m_s * speed) / motor.inertia_kg_m2
        return np.array([rate, acceleration, speed / motor.gear_ratio])


def reference(motor: Motor, circuit: float) -> tuple[Column, Column, Column, float]:
    """Return the same three signals, and the instant at which the motor is disconnected or comes to be shorted."""
    run = Stretches(motor)
    run.go(motor.slow, SUPPLY, 2.0)
    run.go(motor.fast, SUPPLY, 4.0)
    turns = math.ceil((run.state[2] + HALF_WINDOW) / TURN_RAD)
    closing = turns * TURN_RAD - HALF_WINDOW
    run.go(motor.slow, SUPPLY, SECONDS, lambda x: x[2] - closing)
    arrived = run.time
    if circuit == MECHANICAL:
        run.go(motor.slow, 0.0, SECONDS)
    else:
        run.go(motor.slow, -SUPPLY, SECONDS, lambda x: x[2] - (closing - REVERSE))
        run.go(None, 0.0, SECONDS)
    current, speed, angle = np.concatenate(run.samples, axis=1)
    return current, speed, angle, arrived


@pytest.mark.parametrize(("motor", "name"), [(TABLE_5_9, "Table 5-9"), (TABLE_5_6, "Table 5-6")])
@pytest.mark.parametrize("circuit", [MECHANICAL, DEPRESSED])
def test_the_park_sequences_agree_with_an_adaptive_solver(motor: Motor, name: str, circuit: float) -> None:
    *expected, arrived = reference(motor, circuit)
    assert 4.0 < arrived < 6.0
    for signal, ours, theirs in zip(("current", "speed", "angle"), plant(motor, circuit), expected, strict=True):
        error = np.sqrt(np.mean((ours - theirs) ** 2)) / np.ptp(theirs)
        print(f"{name}, circuit {circuit:.0f}, {signal}: {100 * error:.3f} % RMS of range")
        assert error < LIMIT, signal


def test_the_shorted_motor_stops_after_the_angle_on_paper() -> None:
    """R times (3.31) and K times (3.30), integrated to rest: (K^2 + R b) turned = R J w + K L i."""
    current, speed, angle = plant(TABLE_5_9, MECHANICAL)
    brush, motor = TABLE_5_9.slow, TABLE_5_9
    at_park = np.flatnonzero((np.arange(len(angle)) > 4000) & (angle % TURN_RAD >= TURN_RAD - HALF_WINDOW))[0]
    strength = brush.constant_v_s**2 + brush.resistance_ohm * motor.damping_n_m_s
    momentum = brush.resistance_ohm * motor.inertia_kg_m2 * speed[at_park]
    flux = brush.constant_v_s * brush.inductance_henry * current[at_park]
    turned = (momentum + flux) / strength / motor.gear_ratio
    assert angle[-1] - angle[at_park] == pytest.approx(turned, rel=1e-9)
    assert turned == pytest.approx(0.047, abs=0.002)


def test_the_disconnected_motor_runs_out_after_the_angle_on_paper() -> None:
    """Nothing but damping brakes it: b turned = J w."""
    _, speed, angle = plant(TABLE_5_9, DEPRESSED)
    lowest = np.argmin(speed)
    after = lowest + 1 + np.flatnonzero(np.diff(speed[lowest:]) > 0)[0]
    turned = TABLE_5_9.inertia_kg_m2 * speed[after] / TABLE_5_9.damping_n_m_s / 63.0
    left = TABLE_5_9.inertia_kg_m2 * speed[-1] / TABLE_5_9.damping_n_m_s / 63.0
    assert angle[-1] - angle[after] == pytest.approx(turned - left, rel=1e-9)
    assert speed[-1] == pytest.approx(0.0, abs=1e-3)
