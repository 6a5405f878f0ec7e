"""What the supply puts in comes out again: as heat, as work on load and brake, or stored in coil and rotor."""

import numpy as np
import pytest

from hilplant.models.plant import simulate_rows
from hilplant.models.records import Arm, Brush, Load, Motor, Parameters, ParkSwitch, State
from hilplant.models.row import pack
from hilplant.signals import OUTPUT_INDEX, OUTPUTS, Inputs

MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.045, 63.0)
STEP_S = 1e-5


def test_the_energy_balance_closes_over_start_brake_and_stop() -> None:
    arm, switch = Arm(0.0, 0.5), ParkSwitch(0.0, 0.1, 0.0, 0.0)
    parameters = pack(Parameters(STEP_S, MOTOR, switch, Load(1.0, 0.0035, 0.2738), arm, arm))
    inputs = np.tile(pack(Inputs(1.0, 0.0, 13.5, 0.0, 0.0, 0.0)), (50_000, 1))
    inputs[20_000:30_000, 5] = 8.0
    inputs[40_000:, 0] = 0.0
    outputs = np.empty((len(inputs), len(OUTPUTS)))
    simulate_rows(pack(State(0.0, 0.0, 0.0, 1.0, 0.0, 0.0)), inputs, parameters, np.zeros((9, 9, 2)), outputs)
    current, speed, voltage = (outputs[:, OUTPUT_INDEX[n]] for n in ("current_a", "motor_speed_rad_s", "terminal_v"))
    load, crank = outputs[:, OUTPUT_INDEX["load_torque_n_m"]], outputs[:, OUTPUT_INDEX["crank_speed_rad_s"]]

    def total(power: np.ndarray) -> float:
        return float(np.trapezoid(power, dx=STEP_S))

    put_in = total(voltage * current)
    heat = total(MOTOR.slow.resistance_ohm * current**2)
    friction = total(MOTOR.damping_n_m_s * speed**2 + MOTOR.coulomb_torque_n_m * np.abs(speed))
    work = total(load * crank)
    stored = 0.5 * MOTOR.slow.inductance_henry * current[-1] ** 2 + 0.5 * MOTOR.inertia_kg_m2 * speed[-1] ** 2
    assert work > 0.1 * put_in
    assert heat + friction + work + stored == pytest.approx(put_in, rel=1e-4)
