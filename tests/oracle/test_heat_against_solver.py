"""The warm motor against an adaptive solver of all its equations at once, and against what can be said on paper.

The oracle integrates current and both temperatures with scipy's Radau and finds the thermal switch as an event. It
knows no matrix exponential, no mean current of a tick, and no motor that is warmed once a tick.
"""

from typing import Any

import numpy as np
import pytest
from numpy.random import default_rng
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from hilplant.arrays import Floats
from hilplant.models.heat import Losses, mean_square, warmed
from hilplant.models.plant import simulate_rows
from hilplant.models.records import Arm, Brush, Load, Motor, Parameters, ParkSwitch, State, Wiring
from hilplant.models.row import pack
from hilplant.models.slow_records import Heat, HeatState
from hilplant.signals import OUTPUT_INDEX, OUTPUTS, Inputs

MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.045, 63.0)
#: Small bodies, so that minutes of a real motor are seconds here.
SMALL = Heat(1.0, 1.5, 6.0, 0.4, 0.35, 0.0039, -0.002, 20.0, 150.0, 110.0, 1.0)
STEP_S = 1e-3


def run(heat: Heat, inputs: Floats, state: State | None = None, **others: Any) -> dict[str, Floats]:
    arm = Arm(0.0, 0.5)
    parameters = Parameters(STEP_S, MOTOR, ParkSwitch(0.0, 0.1, 0.0, 0.0), Load(0.0), arm, arm, heat=heat, **others)
    outputs = np.empty((len(inputs), len(OUTPUTS)))
    simulate_rows(pack(state or State()), inputs, pack(parameters), np.zeros((9, 9, 2)), outputs)
    return {name: outputs[:, index] for name, index in OUTPUT_INDEX.items()}


def inputs_for(ticks: int, **values: float) -> Floats:
    return np.tile(pack(Inputs(**values)), (ticks, 1))


def stalled(heat: Heat, seconds: float, ambient_c: float) -> Any:
    """Integrate a motor that stands at 13.5 V until the thermal switch opens; return times, and i, Tw and Tc."""
    brush = MOTOR.slow

    def rates(_: float, x: Floats) -> list[float]:
        ohm = brush.resistance_ohm * (1.0 + heat.resistance_per_k * (x[1] - 20.0))
        across = heat.winding_to_case_w_k * (x[1] - x[2])
        return [
            (13.5 - ohm * x[0]) / brush.inductance_henry,
            (ohm * x[0] ** 2 - across) / heat.winding_j_k,
            (across - heat.case_to_ambient_w_k * (x[2] - ambient_c)) / heat.case_j_k,
        ]

    def trips(_: float, x: Floats) -> float:
        return float(x[1]) - heat.trip_c

    trips.terminal = True  # type: ignore[attr-defined]
    start, span = [0.0, 20.0, 20.0], (0.0, seconds)
    return solve_ivp(rates, span, start, "Radau", rtol=1e-10, atol=1e-9, events=trips, dense_output=True)


@pytest.mark.parametrize("ambient_c", [-40.0, 20.0, 80.0])
def test_a_stall_lets_the_current_fall_and_trips_when_the_solver_says(ambient_c: float) -> None:
    truth = stalled(SMALL, 10.0, ambient_c)
    inputs = inputs_for(4000, relay_on=1.0, brake_torque_n_m=100.0, ambient_temperature_c=ambient_c)
    seen = run(SMALL, inputs)
    tripped = int(np.argmax(seen["thermal_switch"]))
    assert tripped * STEP_S == pytest.approx(truth.t[-1], abs=2 * STEP_S)
    times = np.arange(tripped) * STEP_S
    current, winding, _ = truth.sol(times)
    assert np.abs(seen["winding_temperature_c"][:tripped] - winding).max() < 1e-3 * 130.0
    assert np.abs(seen["current_a"][:tripped] - current).max() < 1e-3 * current.max()
    assert seen["current_a"][tripped - 1] == pytest.approx(13.5 / (1.237 * (1.0 + 0.0039 * 130.0)), rel=1e-3)
    assert (seen["current_a"][tripped + 1 : tripped + 200] == 0.0).all()


def test_the_switch_closes_at_its_reset_temperature_and_the_motor_presses_again() -> None:
    seen = run(SMALL, inputs_for(9000, relay_on=1.0, brake_torque_n_m=100.0))
    opened = np.flatnonzero(np.diff(seen["thermal_switch"]) > 0.0)
    closed = np.flatnonzero(np.diff(seen["thermal_switch"]) < 0.0)
    assert len(opened) >= 2 and len(closed) >= 1
    winding = seen["winding_temperature_c"]
    assert winding[opened[0] + 1] == pytest.approx(150.0, abs=0.2)
    assert winding[closed[0] + 1] == pytest.approx(110.0, abs=0.2)
    assert seen["current_a"][closed[0] + 100] > 5.0


@pytest.mark.parametrize("harness_ohm", [0.0, 0.15])
def test_what_the_supply_puts_in_is_heat_in_the_bodies_the_air_and_the_harness(harness_ohm: float) -> None:
    """Start, run, change of brush, brake and stop without load: all energy ends as heat, to 0.1 %."""
    heat = SMALL._replace(has_switch=0.0, winding_j_k=15.0, case_j_k=60.0)
    inputs = inputs_for(12_000, relay_on=1.0)
    inputs[3000:6000, 1], inputs[9000:, 0] = 1.0, 0.0
    wiring = Wiring(altered=1.0, supply_resistance_ohm=harness_ohm) if harness_ohm else Wiring()
    out = run(heat, inputs, wiring=wiring)
    current, on = out["current_a"], inputs[:-1, 0]
    mean_a = 0.5 * (current[:-1] + current[1:])
    put_in = float((13.5 * on * mean_a).sum() * STEP_S)
    lost = float((harness_ohm * on * mean_a**2).sum() * STEP_S)
    winding, case, to_air = out["winding_temperature_c"], 20.0, 0.0
    speed = np.abs(out["motor_speed_rad_s"])
    friction_w = MOTOR.damping_n_m_s * speed**2 + MOTOR.coulomb_torque_n_m * speed
    for hot, rubbing in zip(winding[:-1], 0.5 * (friction_w[:-1] + friction_w[1:]), strict=True):  # by Euler's rule
        leaves = heat.case_to_ambient_w_k * (case - 20.0)
        to_air += STEP_S * leaves
        case += STEP_S / heat.case_j_k * (heat.winding_to_case_w_k * (hot - case) + rubbing - leaves)
    stored = heat.winding_j_k * (winding[-1] - 20.0) + heat.case_j_k * (case - 20.0)
    assert stored + to_air + lost == pytest.approx(put_in, rel=1e-3)
    assert stored > 0.5 * put_in


@pytest.mark.parametrize("seed", range(20))
def test_both_bodies_follow_the_exponential_of_their_matrix(seed: int) -> None:
    random = default_rng(seed)
    cw, cc, g, a = (10.0 ** random.uniform(-1.0, 3.0) for _ in range(4))
    p, f, air = random.uniform(0.0, 300.0), random.uniform(0.0, 30.0), random.uniform(-40.0, 90.0)
    step_s = (0.5, 1e-3)[seed % 2]  # by eigenvalues, and by the series
    heat = Heat(1.0, cw, cc, g, a)
    matrix = np.array([[-g / cw, g / cw, p / cw], [g / cc, -(g + a) / cc, (f + a * air) / cc], [0.0, 0.0, 0.0]])
    expected = expm(matrix * step_s) @ [70.0, 30.0, 1.0]
    now = warmed(HeatState(70.0, 30.0, 0.0), Losses(p, f, air), heat, step_s)
    assert (now.winding_c, now.case_c) == pytest.approx(tuple(expected[:2]), rel=1e-9)


def test_the_mean_square_is_exact_for_a_parabola() -> None:
    current = np.polynomial.Polynomial([3.0, -7.0, 2.5])
    whole, square = current.integ(), (current * current).integ()
    assert mean_square(current(0.0), whole(1.0), current(1.0)) == pytest.approx(square(1.0), rel=1e-14)


def test_without_heat_nothing_gets_warm_and_no_bit_of_the_motion_changes() -> None:
    inputs = inputs_for(300, relay_on=1.0)
    cold, air = run(Heat(), inputs), run(Heat(), inputs_for(300, relay_on=1.0, ambient_temperature_c=90.0))
    assert all((cold[name] == air[name]).all() for name in cold)
    assert (cold["winding_temperature_c"] == 20.0).all() and (cold["thermal_switch"] == 0.0).all()
    # heat that changes nothing: no coefficients, no switch
    inert = run(SMALL._replace(resistance_per_k=0.0, constant_per_k=0.0, has_switch=0.0), inputs)
    assert (inert["current_a"] == cold["current_a"]).all()
    assert inert["winding_temperature_c"][-1] > 20.0


def test_a_hot_motor_has_the_no_load_speed_of_its_weaker_magnets() -> None:
    """On paper: w = (V K - R M)/(R d + K^2) with R and K at 120 degC."""
    heat = SMALL._replace(winding_j_k=1e9, case_j_k=1e9)
    state = State(heat=HeatState(120.0, 120.0, 0.0))
    seen = run(heat, inputs_for(1500, relay_on=1.0), state)
    ohm, constant = 1.237 * (1.0 + 0.0039 * 100.0), 4.579e-2 * (1.0 - 0.002 * 100.0)
    expected = (13.5 * constant - ohm * 0.045) / (ohm * 1.582e-4 + constant**2)
    assert seen["motor_speed_rad_s"][-1] == pytest.approx(expected, rel=1e-6)
