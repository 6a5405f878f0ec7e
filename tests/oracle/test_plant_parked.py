"""A parked wiper stands still for an hour, however it came there and whatever holds it."""

import math

import numpy as np
import pytest
from support.closed_form import ClosedFormWiper

from hilplant.models import tables as channel
from hilplant.models.plant import simulate_rows
from hilplant.models.records import Arm, Blade, Brush, Friction, Load, Motor, Parameters, ParkSwitch, State
from hilplant.models.row import pack
from hilplant.signals import OUTPUT_INDEX, OUTPUTS, Inputs

MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.0, 63.0)
STIFF = Motor(Brush(8.0, 9e-5, 9.55e-4), Brush(3.9, 1.2e-5, 6.88e-4), 2e-9, 2e-3, 0.0, 1.0)
BLOCK = 60_000
HOUR_BLOCKS = 60


@pytest.mark.parametrize(
    ("motor", "dry", "relay_on", "brake"),
    [(MOTOR, 0.0, 0.0, 0.0), (MOTOR, 0.045, 0.0, 0.0), (MOTOR, 0.045, 1.0, 60.0), (STIFF, 2e-4, 0.0, 0.0)],
)
def test_a_parked_wiper_keeps_its_angle_for_an_hour(motor: Motor, dry: float, relay_on: float, brake: float) -> None:
    switch, arm = ParkSwitch(0.0, 0.1, 0.02, 3.0), Arm(0.0, 0.5)
    motor = motor._replace(coulomb_torque_n_m=dry)
    parameters = pack(Parameters(1e-3, motor, switch, Load(1.0, 0.0035, 0.2738), arm, arm))
    tables, outputs = np.zeros((9, 9, 2)), np.empty((BLOCK, len(OUTPUTS)))
    inputs = np.tile(pack(Inputs(relay_on, 0.0, 13.5, 0.0, 0.0, brake)), (BLOCK, 1))
    state = pack(State(8.0, 250.0, 1.0, 0.0, 0.0, 0.0))
    simulate_rows(state, inputs[:2000], parameters, tables, outputs)  # comes to rest
    rest = state[2]
    assert rest > 1.0
    for _ in range(HOUR_BLOCKS):
        simulate_rows(state, inputs, parameters, tables, outputs)
        angles = outputs[:, OUTPUT_INDEX["crank_angle_rad"]]
        assert np.abs(angles - rest).max() <= 1e-9
        assert np.ptp(outputs[:, OUTPUT_INDEX["park_contact"]]) == 0.0
    assert math.isfinite(state[0])
    assert state[1] == 0.0


@pytest.mark.parametrize(("relay_on", "brake", "screen"), [(0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 60.0, 1.0)])
def test_a_whole_wiper_keeps_its_angle_for_an_hour_though_gravity_pulls(
    relay_on: float, brake: float, screen: float
) -> None:
    wiper = ClosedFormWiper()
    blade = Blade(7.615, 1.0)
    friction = Friction(0.32, 0.12, 2.0, 20.0, 0.45, 4.5, 7.6e-3, 0.68, 6.8, 2.8e-4, 3.5e-3, 2.4, 0.5, 0.6, 0.02)
    load = Load(2.0, friction=friction, left_blade=blade, right_blade=blade)
    parameters = pack(Parameters(1e-3, MOTOR, ParkSwitch(0.0, 0.1, 0.02, 3.0), load, Arm(0.0, 0.7), Arm(0.0, 0.5)))
    tables, outputs = wiper.tables(), np.empty((BLOCK, len(OUTPUTS)))
    inputs = np.tile(pack(Inputs(relay_on, 0.0, 13.5, screen, 20.0, brake)), (BLOCK, 1))
    state = pack(State(8.0, 250.0, 1.0, 0.0, 0.0, 0.0))
    simulate_rows(state, inputs[:2000], parameters, tables, outputs)  # comes to rest
    rest = state[2]
    assert abs(wiper.channels(rest)[channel.GRAVITY, 0]) > 0.05
    torque = relay_on * MOTOR.slow.constant_v_s * 13.5 / MOTOR.slow.resistance_ohm
    pressing = MOTOR.gear_ratio * max(0.0, torque - MOTOR.coulomb_torque_n_m)
    for _ in range(HOUR_BLOCKS):
        simulate_rows(state, inputs, parameters, tables, outputs)
        assert (outputs[:, OUTPUT_INDEX["crank_angle_rad"]] == rest).all()
        assert (outputs[:, OUTPUT_INDEX["motor_speed_rad_s"]] == 0.0).all()
        assert outputs[:, OUTPUT_INDEX["load_torque_n_m"]] == pytest.approx(pressing)
