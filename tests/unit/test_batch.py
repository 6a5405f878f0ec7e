"""Many sets in one call: the same bits as one by one, however many threads; wrong shapes are refused by name."""

from typing import Any

import numpy as np
import pytest
from support.closed_form import ClosedFormWiper

from hilplant.arrays import Floats
from hilplant.models.plant import simulate_rows
from hilplant.models.records import (
    PARAMETER_INDEX,
    Arm,
    Blade,
    Brush,
    Friction,
    Load,
    Motor,
    Parameters,
    ParkSwitch,
    State,
)
from hilplant.models.row import pack
from hilplant.signals import OUTPUT_INDEX, OUTPUTS
from hilplant.simulation.batch import simulate_batch
from hilplant.thesis.solver import Rows

MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.02, 63.0)
SETS, TICKS = 11, 400
COLUMNS = ("crank_angle_rad", "current_a", "load_torque_n_m")
TABLES = ClosedFormWiper().tables(256)


def plant(force_n: float, inertia_kg_m2: float) -> Floats:
    friction = Friction(0.3, 0.12, 2.0, 20.0, 0.45, 4.5, 7.6e-3, 0.68, 6.8, 2.8e-4, 3.5e-3, 2.4, 0.5, 0.6, 0.02)
    load = Load(2.0, points=1.0, friction=friction, left_blade=Blade(force_n), right_blade=Blade(force_n))
    motor = MOTOR._replace(inertia_kg_m2=inertia_kg_m2)
    return pack(Parameters(1e-3, motor, ParkSwitch(0.0, 0.1, 0.02, 3.0), load, Arm(0.3, 0.69), Arm(-0.4, 0.54)))


def sets() -> tuple[Floats, Floats]:
    random = np.random.default_rng(5)
    parameters = [plant(random.uniform(2.0, 12.0), random.uniform(1e-5, 5e-5)) for _ in range(SETS)]
    return np.array([pack(State(0.0, 0.0, 0.1 * k, 0.0, 0.0, 0.0)) for k in range(SETS)]), np.array(parameters)


@pytest.mark.parametrize("threads", [1, 2, 5])
@pytest.mark.parametrize("own", [False, True])
def test_every_set_gives_the_bits_of_a_run_of_its_own(threads: int, own: bool) -> None:
    states, parameters = sets()
    inputs = Rows(TICKS, screen=1.0, relay_on=1.0).set(250, TICKS, relay_on=0.0).rows
    every = np.array([inputs] * SETS)
    every[:, :, 2] += np.arange(SETS)[:, np.newaxis] * own
    tables = np.array([TABLES * (1.0 + 0.01 * k * own) for k in range(SETS)])
    alone = np.empty((SETS, TICKS, len(OUTPUTS)))
    ends = states.copy()
    for k in range(SETS):
        simulate_rows(ends[k], every[k], parameters[k], tables[k], alone[k])
    found = simulate_batch(
        states, every if own else inputs, parameters, tables if own else TABLES, COLUMNS, threads=threads
    )
    assert found.tobytes() == np.ascontiguousarray(alone[:, :, [OUTPUT_INDEX[name] for name in COLUMNS]]).tobytes()
    assert states.tobytes() == ends.tobytes()
    assert np.ptp(found[:, -1, 0]) > 0.1


def test_no_sets_are_no_error() -> None:
    states, parameters = sets()
    assert simulate_batch(states[:0], Rows(3).rows, parameters[:0], TABLES, COLUMNS).shape == (0, 3, 3)


def test_the_named_places_are_where_packing_puts_them() -> None:
    row = plant(1.0, 1e-5)
    assert (len(row), row[PARAMETER_INDEX["load.model"]], row[PARAMETER_INDEX["load.points"]]) == (
        len(PARAMETER_INDEX),
        2.0,
        1.0,
    )


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"state_rows": np.zeros((SETS - 1, 7))}, "state_rows"),
        ({"parameter_rows": np.zeros((SETS, 3))}, "parameter_rows"),
        ({"input_rows": np.zeros((SETS - 1, TICKS, 12))}, "input_rows"),
        ({"tables": TABLES[:, :8]}, "channels"),
        ({"columns": [99]}, "columns"),
        ({"output": np.zeros((SETS, TICKS, 2))}, "output"),
        ({"output": np.zeros((SETS, TICKS, 3), dtype=np.float32)}, "output"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(change: dict[str, Floats], name: str) -> None:
    states, parameters = sets()
    right: dict[str, Any] = {
        "state_rows": states,
        "input_rows": Rows(TICKS).rows,
        "parameter_rows": parameters,
        "tables": TABLES,
        "columns": COLUMNS,
    }
    with pytest.raises(ValueError, match=name):
        simulate_batch(**(right | change))
