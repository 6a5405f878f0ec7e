"""No network is active while anything differs from its training: every fault, every bench key, every element set."""

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.faults.catalogue import FAULTS
from hilplant.faults.fault import FaultDefinition
from hilplant.faults.player import FaultPlayer
from hilplant.faults.timing import Inserted
from hilplant.models.load import LOADS
from hilplant.models.motor_choice import MOTORS
from hilplant.models.plant import simulate_rows
from hilplant.models.records import PARAMETER_INDEX
from hilplant.models.row import pack, summed
from hilplant.models.training import load_mark, motor_mark
from hilplant.signals import ACTIVE_MODELS, INPUT_INDEX, OUTPUT_INDEX, OUTPUTS

BENCH = load_bench("networks")
NETWORK = ACTIVE_MODELS.index("network")
TICKS = 700
#: What a fault may change without the networks knowing less: it is none of their business.
HARMLESS = ("relays.", "sensors.", "park_switch.")


def modes(row: np.ndarray, second: np.ndarray | None = None) -> list[set[float]]:
    """Run wet at full speed; return who was active after 0.6 s for load and motor, with the second row from then on."""
    state, inputs = BENCH.state_row.copy(), np.tile(BENCH.input_row, (TICKS, 1))
    inputs[:, INPUT_INDEX["relay_on"]], inputs[:, INPUT_INDEX["screen"]] = 1.0, 1.0
    outputs = np.empty((TICKS, len(OUTPUTS)))
    simulate_rows(state, inputs[:600], row, BENCH.tables, outputs[:600])
    simulate_rows(state, inputs[600:], row if second is None else second, BENCH.tables, outputs[600:])
    return [set(outputs[605:, OUTPUT_INDEX[name]]) for name in ("load_mode", "motor_mode")]


def test_both_networks_are_active_without_a_fault() -> None:
    assert modes(BENCH.parameter_row) == [{NETWORK}, {NETWORK}]
    assert BENCH.parameters.load.model == LOADS.index("network") and BENCH.parameters.motor_model == MOTORS.index(
        "narx"
    )


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_a_fault_that_changes_the_plant_takes_its_network_out(fault: FaultDefinition) -> None:
    values = fault.complete({q.name: q.default if q.default is not None else 0.3 * q.maximum + 0.7 * q.minimum
                             for q in fault.quantities})  # fmt: skip
    row = BENCH.parameter_row.copy()
    for index, value in FaultPlayer([Inserted(fault, values)], row, 1e-3).changes(0).items():
        row[index] = value
    load, motor = modes(BENCH.parameter_row, row)
    elements = [change.element for change in fault.changes]
    if any(name.startswith(("load.", "obstacles.", "linkage.")) for name in elements):
        assert NETWORK not in load
    if any(not name.startswith((*HARMLESS, "load.")) for name in elements):
        assert NETWORK not in motor


@pytest.mark.parametrize("name", [name for name in PARAMETER_INDEX if name.startswith(("load.", "motor."))])
def test_no_element_of_load_or_motor_changes_unnoticed(name: str) -> None:
    """Whoever changes it, as `hilplant set` may: the sum over the elements tells."""
    from hilplant.models.records import Parameters
    from hilplant.models.row import unpack

    row = BENCH.parameter_row.copy()
    row[PARAMETER_INDEX[name]] = row[PARAMETER_INDEX[name]] * 1.001 + 1e-6
    changed = unpack(Parameters, row)
    known = name.startswith(("load.model", "load.c1", "load.c2", "motor.gear_eff", "motor.gear_back"))
    seen = (load_mark(changed.load), motor_mark(changed.motor)) != (
        BENCH.parameters.trained_load, BENCH.parameters.trained_motor)  # fmt: skip
    assert seen is not known


def test_changes_that_cancel_in_a_plain_sum_are_seen() -> None:
    blade = BENCH.parameters.load.left_blade
    assert summed(blade._replace(force_n=blade.force_n + 0.5, wear=blade.wear - 0.5)) != summed(blade)
    load = BENCH.parameters.load
    swapped = load._replace(left_blade=blade._replace(wear=0.5), right_blade=blade._replace(wear=1.5))
    assert load_mark(swapped) != load_mark(load)
    assert pack(BENCH.parameters)[PARAMETER_INDEX["trained_load"]] == load_mark(load)
