"""The plant without tables at 1 ms against an adaptive solver at tight tolerance, for every published motor.

The reference (hilplant/thesis/reference.py) shares no code with the step: it writes (3.30), (3.31) and (6.3) down
once more, and treats dry friction as a switched system whose switching instants are located by the solver's events.
"""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml

from hilplant.arrays import Floats
from hilplant.models.plant import tick
from hilplant.models.records import Arm, Brush, Load, Motor, Parameters, ParkSwitch, State
from hilplant.models.row import pack
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, OUTPUTS
from hilplant.thesis.solver import Rows, SolverErrors, compare

MOTORS = Path(__file__).parents[2] / "config" / "motors"
LIMIT_PERCENT = 0.5

#: Motor, dry friction at its shaft [N m], load model. Table 3-1 has the ratio 1, so its load is the stiffest.
CASES = [
    ("table_3_1", 0.0, 0.0),
    ("table_3_1", 0.0, 1.0),
    ("table_3_1", 2e-4, 1.0),
    ("table_5_6", 0.0, 1.0),
    ("table_5_6", 0.045, 1.0),
    ("table_5_8", 0.0, 1.0),
    ("table_5_8", 0.045, 1.0),
    ("table_5_9", 0.0, 1.0),
    ("table_5_9", 0.045, 1.0),
    ("figure_8_3", 0.0, 1.0),
    ("figure_8_3", 2e-4, 1.0),
]


def plant_of(name: str, dry: float, model: float) -> Parameters:
    text = yaml.safe_load((MOTORS / f"{name}.yaml").read_text())
    brushes = Brush(**text["slow"]), Brush(**text["fast"])
    motor = Motor(*brushes, text["inertia_kg_m2"], text["damping_n_m_s"], dry, text["gear_ratio"])
    switch = ParkSwitch(0.0, math.radians(5.0), math.radians(1.0), 3.0)
    return Parameters(1e-3, motor, switch, Load(model, 0.0035, 0.2738), Arm(0.1, 0.6), Arm(-0.2, 0.5))


def tables() -> Floats:
    return np.zeros((9, 9, 2))


def errors_of(plant: Parameters, inputs: Floats) -> SolverErrors:
    return compare(plant, tables(), lambda _: tables()[0], inputs)


def scenario() -> Floats:
    """Slow, a voltage step, fast, stall and release by the brake, slow again, off."""
    rows = Rows(620).set(10, 560, relay_on=1).set(130, 220, supply_v=10.0)
    return rows.set(220, 480, relay_fast=1).set(320, 400, brake_torque_n_m=60.0).rows


@pytest.mark.parametrize(("name", "dry", "model"), CASES)
def test_switching_and_stall_agree_with_the_adaptive_solver(name: str, dry: float, model: float) -> None:
    errors = errors_of(plant_of(name, dry, model), scenario())
    print(f"\n{name:<11} dry {dry:<6} load {model:g} RMS of range: "
          f"current {errors.current_percent:.1e} %, speed {errors.speed_percent:.1e} %", end="")  # fmt: skip
    assert errors.worst_percent < LIMIT_PERCENT / 10.0
    turned = errors.outputs[-1, OUTPUT_INDEX["crank_angle_rad"]] - errors.truth[-1, 2]
    assert abs((turned + math.pi) % (2.0 * math.pi) - math.pi) < 2e-4


def park_inputs(plant: Parameters) -> Floats:
    """Run slow for a turn and switch off at the tick after the park contact closes, as an ECU does."""
    rows = Rows(1900, relay_on=1).rows
    state, output = pack(State(0.0, 0.0, 0.0, 1.0, 0.0, 0.0)), np.empty(len(OUTPUTS))
    parameters, table, left_window = pack(plant), tables(), False
    for k, row in enumerate(rows):
        tick(state, row, parameters, table, output)
        left_window |= output[OUTPUT_INDEX["crank_angle_rad"]] > 1.0
        if left_window and output[OUTPUT_INDEX["park_contact"]]:
            rows[k + 1 :, INPUT_INDEX["relay_on"]] = 0.0
    return rows


@pytest.mark.parametrize(("name", "dry"), [("table_5_6", 0.0), ("table_5_9", 0.0), ("table_5_9", 0.045)])
def test_a_park_stop_agrees_with_the_adaptive_solver(name: str, dry: float) -> None:
    plant = plant_of(name, dry, 1.0)
    inputs = park_inputs(plant)
    errors = errors_of(plant, inputs)
    stop = errors.outputs[-1, OUTPUT_INDEX["crank_angle_rad"]]
    print(f"\n{name:<11} dry {dry:<6} park: current {errors.current_percent:.1e} %, "
          f"speed {errors.speed_percent:.1e} %, stops at {math.degrees(stop):.3f} deg", end="")  # fmt: skip
    assert inputs[-1, INPUT_INDEX["relay_on"]] == 0.0
    assert errors.worst_percent < LIMIT_PERCENT / 10.0
    assert abs(stop - (errors.truth[-1, 2] % (2.0 * math.pi))) < 2e-4
    assert errors.outputs[-1, OUTPUT_INDEX["park_contact"]] == 1.0
