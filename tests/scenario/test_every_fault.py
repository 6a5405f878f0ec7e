"""Every fault of the plant: what it does is seen in the outputs, and when it has gone nothing of it is left.

Each runs on the default and on the mechanical bench, where terminal 53e and the park contact carry current: slow,
fast, off, and slow again. Where a fault came and went while the wiper was parked and did not move it, all that follows
must be bit for bit as without it.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from hilplant.arrays import Floats
from hilplant.bench import Bench, load_bench
from hilplant.faults.catalogue import BY_NAME, FAULTS
from hilplant.faults.fault import FaultDefinition
from hilplant.faults.player import FaultPlayer
from hilplant.faults.timing import Inserted
from hilplant.models.plant import simulate_rows
from hilplant.models.records import STATE_INDEX
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, OUTPUTS

#: Values where the middle of the range would do nothing, or where a name alone does not say what is seen.
VALUES: dict[str, dict[str, float]] = {
    "jam": {"angle_deg": 60.0}, "current_sensor_saturates": {"limit_a": 2.0},
    "left_snow_above": {"angle_deg": -360.0}, "left_stop_above": {"angle_deg": -360.0},
    "right_snow_above": {"angle_deg": -360.0}, "right_stop_above": {"angle_deg": -360.0},
    "left_snow_below": {"angle_deg": 360.0}, "left_stop_below": {"angle_deg": 360.0},
    "right_snow_below": {"angle_deg": 360.0}, "right_stop_below": {"angle_deg": 360.0},
}  # fmt: skip
#: What faults remember by design: the sensor's noise goes on where it was.
REMEMBERED = ("noise",)
PHYSICAL = ("current_a", "motor_speed_rad_s", "crank_angle_rad", "park_contact")
PARKED, WIPING = 300, 1900


@cache
def bench(name: str) -> Bench:
    return load_bench(name)


def inserted(fault: FaultDefinition) -> Inserted:
    middle = {q.name: q.default if q.default is not None else q.minimum + 0.3 * (q.maximum - q.minimum)
              for q in fault.quantities}  # fmt: skip
    middle |= {name: min(value, 0.05) for name, value in middle.items() if name == "time_s"}
    return Inserted(fault, fault.complete(middle | VALUES.get(fault.name, {})))


def row_with(fault: FaultDefinition, name: str) -> Floats:
    row = bench(name).parameter_row.copy()
    for index, value in FaultPlayer([inserted(fault)], row, 1e-3).changes(0).items():
        row[index] = value
    return row


def drive(name: str) -> Floats:
    """Return inputs: slow, fast, off and slow again on a wet screen."""
    rows = np.tile(bench(name).input_row, (WIPING, 1))
    rows[:, INPUT_INDEX["screen"]] = 1.0
    on, fast = rows[:, INPUT_INDEX["relay_on"]], rows[:, INPUT_INDEX["relay_fast"]]
    on[100:1300], on[1600:] = 1.0, 1.0
    fast[700:1300] = 1.0
    return rows


def run(name: str, parts: list[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    """Run rows of inputs with rows of parameters one after the other; return outputs and the last state."""
    state, found = bench(name).state_row.copy(), []
    for inputs, parameters in parts:
        outputs = np.empty((len(inputs), len(OUTPUTS)))
        simulate_rows(state, inputs, parameters, bench(name).tables, outputs)
        found.append(outputs)
    return np.concatenate(found), state


#: Terminal 31 is ground already: this short circuit is the current's other way where the wire is broken, tested below.
SEEN = [fault for fault in FAULTS if fault.name != "short_31_to_31"]


@pytest.mark.parametrize("fault", SEEN, ids=lambda fault: fault.name)
def test_the_effect_of_a_fault_is_seen_in_the_outputs(fault: FaultDefinition) -> None:
    differing = 0.0
    for name in ("default", "mechanical"):
        without, _ = run(name, [(drive(name), bench(name).parameter_row)])
        faulty, _ = run(name, [(drive(name), row_with(fault, name))])
        differing = max(differing, float(np.abs(faulty - without).max()))
        assert np.isfinite(faulty).all()
    assert differing > 1e-3, "no output tells it"


def shorted_at_31(*others: str, touching: bool = True) -> Floats:
    """Return the outputs of the default bench with faults, and with terminal 31 touching ground by 0.01 ohm."""
    faults = [inserted(BY_NAME[name]) for name in others]
    if touching:
        faults.append(inserted(BY_NAME["short_31_to_31"]))
    row = bench("default").parameter_row.copy()
    for index, value in FaultPlayer(faults, row, 1e-3).changes(0).items():
        row[index] = value
    return run("default", [(drive("default"), row)])[0]


def test_terminal_31_at_ground_changes_nothing_while_its_wire_is_sound_and_replaces_it_where_it_is_broken() -> None:
    current = OUTPUT_INDEX["current_a"]
    sound, beside = shorted_at_31(touching=False), shorted_at_31()
    assert beside == pytest.approx(sound, rel=1e-9, abs=1e-9)
    broken, replaced = shorted_at_31("open_31", touching=False), shorted_at_31("open_31")
    assert np.abs(broken[:, current]).max() < 1e-9
    assert np.abs(sound[:, current]).max() > 3.0
    in_series = bench("default").parameter_row.copy()
    resistance = FaultPlayer([Inserted(BY_NAME["resistance_31"], {"resistance_ohm": 0.01})], in_series, 1e-3)
    for index, value in resistance.changes(0).items():
        in_series[index] = value
    truth, _ = run("default", [(drive("default"), in_series)])
    assert replaced[:, current] == pytest.approx(truth[:, current], rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_a_fault_that_has_gone_leaves_nothing_behind(fault: FaultDefinition) -> None:
    name = "default"
    own, parked = bench(name).parameter_row, np.tile(bench(name).input_row, (PARKED, 1))
    _, before = run(name, [(parked, own), (parked[:2], own)])
    _, state = run(name, [(parked, row_with(fault, name)), (parked[:2], own)])
    moved = any(state[STATE_INDEX[each]] != before[STATE_INDEX[each]] for each in PHYSICAL)
    left = {each for each, index in STATE_INDEX.items() if state[index] != before[index]}
    assert left <= {*REMEMBERED, *(PHYSICAL if moved else ())}, left
    if not moved:
        _, after = run(name, [(parked, row_with(fault, name)), (parked[:2], own), (drive(name), own)])
        clean, expected = run(name, [(parked, own), (parked[:2], own), (drive(name), own)])
        faulty, _ = run(name, [(parked, row_with(fault, name)), (parked[:2], own), (drive(name), own)])
        assert np.array_equal(faulty[PARKED + 2 :], clean[PARKED + 2 :])
        assert {each for each, index in STATE_INDEX.items() if after[index] != expected[index]} <= {*REMEMBERED}


def test_most_faults_do_not_move_a_parked_wiper_so_that_the_test_above_looks_at_bits() -> None:
    name = "default"
    parked = np.tile(bench(name).input_row, (PARKED, 1))
    _, before = run(name, [(parked, bench(name).parameter_row)])
    still = 0
    for fault in FAULTS:
        _, state = run(name, [(parked, row_with(fault, name))])
        still += all(state[STATE_INDEX[each]] == before[STATE_INDEX[each]] for each in PHYSICAL)
    assert still > 0.7 * len(FAULTS)


def test_every_fault_says_its_equation_or_what_its_contact_does() -> None:
    page = (Path(__file__).parents[2] / "docs" / "faults.md").read_text(encoding="utf-8")
    for fault in FAULTS:
        assert len(fault.effect) > 10 and "see models" not in fault.effect, fault.name
        assert f"| `{fault.name}` |" in page and fault.effect in page, fault.name
