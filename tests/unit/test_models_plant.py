"""The step from outside: order of its list, relays, park switch, guard, and one result however it is called."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from hilplant.models import tables as channel
from hilplant.models.plant import simulate_rows, tick
from hilplant.models.records import Arm, Brush, Load, Motor, Parameters, ParkSwitch, State
from hilplant.models.row import pack, unpack
from hilplant.signals import INPUTS, OUTPUTS, Inputs, Outputs

MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.045, 63.0)
SWITCH = ParkSwitch(0.0, 0.1, 0.02, 3.0)
PARAMETERS = Parameters(1e-3, MOTOR, SWITCH, Load(1.0, 0.0035, 0.2738), Arm(0.3, 0.6), Arm(-0.4, 0.5))
START = State(0.0, 0.0, 0.0, 1.0, 0.0, 0.0)
SLOW = Inputs(1.0, 0.0, 13.5, 0.0, 0.0, 0.0)

Rows = NDArray[np.float64]


def tables() -> Rows:
    angle = np.linspace(0.0, 2.0 * math.pi, 361)
    channels = np.zeros((361, channel.channels(1), 2))
    for rocker, swing in ((channel.LEFT_ROCKER, 0.7), (channel.RIGHT_ROCKER, 0.6)):
        channels[:, rocker] = np.stack([swing * np.sin(angle), swing * np.cos(angle)], axis=1)
    return channels


def run(inputs: Rows, state: State = START, parameters: Parameters = PARAMETERS) -> Any:
    """Return the outputs as a record of columns."""
    rows = np.empty((len(inputs), len(OUTPUTS)))
    simulate_rows(pack(state), inputs, pack(parameters), tables(), rows)
    return Outputs(*rows.T)


def slow(ticks: int) -> Rows:
    return np.tile(pack(SLOW), (ticks, 1))


def test_records_have_the_signals_in_their_order() -> None:
    assert Inputs._fields == tuple(signal.name for signal in INPUTS)
    assert Outputs._fields == tuple(signal.name for signal in OUTPUTS)


def test_packing_and_unpacking_are_inverse() -> None:
    row = pack(PARAMETERS._replace(networks=np.array([1.0, 2.5])))
    found = unpack(Parameters, row)
    assert found[:-1] == PARAMETERS[:-1]
    assert found.networks.tolist() == [1.0, 2.5]
    assert pack(found).tobytes() == row.tobytes()
    assert unpack(State, pack(START)) == START
    assert unpack(Inputs, pack(SLOW)) == SLOW


def test_tick_by_tick_gives_the_same_bits_as_all_rows_at_once() -> None:
    random = np.random.default_rng(3)
    largest = [min(signal.maximum, 40.0) for signal in INPUTS]
    inputs = np.repeat(random.uniform(0, 1, (60, len(INPUTS))) * largest, 25, axis=0)
    at_once, one_by_one = np.empty((2, len(inputs), len(OUTPUTS)))
    states = np.array([pack(START)] * 2)
    simulate_rows(states[0], inputs, pack(PARAMETERS), tables(), at_once)
    parameters, table = pack(PARAMETERS), tables()
    for row, output in zip(inputs, one_by_one, strict=True):
        tick(states[1], row, parameters, table, output)
    assert at_once.tobytes() == one_by_one.tobytes()
    assert states[0].tobytes() == states[1].tobytes()


def test_the_first_row_is_the_initial_state_with_the_inputs_in_force() -> None:
    out = run(slow(3), State(0.5, 10.0, 1.0, 0.0, 0.0, 0.0))
    assert (out.terminal_v[0], out.current_a[0], out.motor_speed_rad_s[0], out.crank_angle_rad[0]) == (
        13.5,
        0.5,
        10.0,
        1.0,
    )
    assert out.current_a[1] > 0.5
    assert out.left_rocker_rad[0] == pytest.approx(0.7 * math.sin(1.0), abs=1e-8)
    assert out.left_arm_rad[0] == out.left_rocker_rad[0] + 0.3
    assert out.right_blade_m_s[0] == pytest.approx(0.5 * 0.6 * math.cos(1.0) * 10.0 / 63.0, rel=1e-5)


def test_off_grounds_the_brush_and_brakes_harder_than_an_open_circuit_would() -> None:
    inputs = slow(400)
    inputs[300:, 0] = 0.0
    out = run(inputs)
    assert out.terminal_v[300] == 0.0
    assert out.current_a[300] > 0.0
    assert out.current_a[305] < -1.0  # the back-EMF drives it through the grounded brush
    coasting_s = MOTOR.inertia_kg_m2 * out.motor_speed_rad_s[300] / MOTOR.coulomb_torque_n_m
    assert out.motor_speed_rad_s[300 + int(500 * coasting_s)] == 0.0


def test_current_and_speed_carry_over_when_the_brush_changes() -> None:
    inputs = slow(302)
    inputs[300:, 1] = 1.0
    steady, changed = run(slow(302)), run(inputs)
    assert changed.current_a[300] == steady.current_a[300]
    assert changed.motor_speed_rad_s[300] == steady.motor_speed_rad_s[300]
    assert changed.current_a[301] > steady.current_a[301]


def test_a_large_brake_blocks_the_crank_and_a_stalled_motor_reports_the_torque_it_presses_with() -> None:
    inputs = slow(300)
    inputs[200:, 5] = 100.0
    out = run(inputs)
    assert out.load_torque_n_m[200] == pytest.approx(100.0 + out.load_torque_n_m[199], abs=0.05)
    assert (out.motor_speed_rad_s[210:] == 0.0).all()
    pressing = 63.0 * (MOTOR.slow.constant_v_s * out.current_a[210:] - MOTOR.coulomb_torque_n_m)
    assert out.load_torque_n_m[210:] == pytest.approx(pressing) and 27.0 < pressing[-1] < 32.0
    assert np.ptp(out.crank_angle_rad[210:]) == 0.0
    assert out.current_a[-1] == pytest.approx(13.5 / 1.237)


def test_the_angle_stays_within_a_turn_in_both_directions() -> None:
    backwards = slow(3000)
    backwards[:, 2] = -13.5
    for inputs in (slow(3000), backwards):
        angle = run(inputs).crank_angle_rad
        assert ((angle >= 0.0) & (angle < 2.0 * math.pi)).all()
        assert np.abs(np.diff(angle)).max() > 6.0


@pytest.mark.parametrize("name", Inputs._fields)
@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf])
def test_an_input_that_is_not_finite_stops_the_motor_until_a_restart(name: str, wrong: float) -> None:
    inputs = slow(300)
    inputs[200, Inputs._fields.index(name)] = wrong
    out = run(inputs)
    assert np.isfinite(np.array(out)).all()
    assert (out.guard[:200] == 0.0).all()
    assert (out.guard[200:] == 1.0).all()
    assert (out.current_a[200:] == 0.0).all()
    assert (out.motor_speed_rad_s[200:] == 0.0).all()
    assert (out.crank_angle_rad[200:] == out.crank_angle_rad[200]).all()
    assert out.crank_angle_rad[200] > out.crank_angle_rad[199]


@pytest.mark.parametrize("field", ["current_a", "motor_speed_rad_s", "crank_angle_rad"])
def test_a_state_that_is_not_finite_is_caught(field: str) -> None:
    out = run(slow(5), START._replace(**{field: math.nan}))
    assert np.isfinite(np.array(out)).all()
    assert (out.guard == 1.0).all()


def test_a_motion_that_overflows_is_caught_at_the_next_tick() -> None:
    impossible = PARAMETERS._replace(motor=MOTOR._replace(inertia_kg_m2=0.0))
    out = run(slow(5), parameters=impossible)
    assert np.isfinite(np.array(out)).all()
    assert list(out.guard) == [0.0, 1.0, 1.0, 1.0, 1.0]
