"""The torque network hands over to the physical load where its training ends, in the same tick, and comes back."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from hilplant.arrays import Floats
from hilplant.bench import Bench, load_bench
from hilplant.bench.assembly import initial_state
from hilplant.bench.load_files import TorqueFile
from hilplant.models.circuit import CIRCUITS
from hilplant.models.load import LOADS
from hilplant.models.plant import simulate_rows
from hilplant.models.records import PARAMETER_INDEX, STATE_INDEX
from hilplant.models.row import pack
from hilplant.signals import ACTIVE_MODELS, INPUT_INDEX, OUTPUT_INDEX, OUTPUTS

PHYSICAL, NETWORK, STANDSTILL, OUTSIDE = (ACTIVE_MODELS.index(name) for name in ACTIVE_MODELS)
#: A disturbance lasts from 3 s to 4.5 s of 9 s.
TICKS, BEGIN, END = 9000, 3000, 4500


@pytest.fixture(scope="module")
def bench() -> Bench:
    return load_bench("network")


def wiping(bench: Bench, **changed: float | Floats) -> Floats:
    rows = np.tile(bench.input_row, (TICKS, 1))
    rows[:, INPUT_INDEX["relay_on"]] = 1.0
    for name, values in changed.items():
        rows[BEGIN:END, INPUT_INDEX[name]] = values
    return rows


def both(bench: Bench, inputs: Floats) -> tuple[Callable[[str], Floats], Callable[[str], Floats]]:
    """Run with the network and with the physical load alone; return how to get a column of each."""
    runs = []
    for load in ("network", "reduced"):
        parameters, outputs = bench.parameter_row.copy(), np.empty((len(inputs), len(OUTPUTS)))
        parameters[PARAMETER_INDEX["load.model"]] = LOADS.index(load)
        state = initial_state(bench.parameters, bench.initial)
        simulate_rows(state, inputs, parameters, bench.tables, outputs)
        runs.append(outputs)
    ours, theirs = runs
    return lambda name: ours[:, OUTPUT_INDEX[name]], lambda name: theirs[:, OUTPUT_INDEX[name]]


CASES = {
    "25 V on the fast brush": {"supply_v": 25.0, "relay_fast": 1.0, "screen": 1.0},
    "stall": {"brake_torque_n_m": 1000.0},
    "torque on an unpowered motor, Figure 6-23": {"relay_on": 0.0, "brake_torque_n_m": 10.0},
    "brown-out": {"supply_v": np.interp(np.arange(END - BEGIN), [0, 500, 1000, 1500], [13.5, 3.0, 3.0, 13.5])},
    "no supply": {"supply_v": 0.0},
    "tacky": {"screen": 0.5},
    "half wet": {"screen": np.linspace(0.01, 1.0, END - BEGIN)},
    "one blade wet": {"left_screen": 1.0},
    "wind": {"vehicle_speed_m_s": 40.0},
    "wear": {"right_wear": 2.0},
    "force": {"left_force": 0.0},
}


@pytest.mark.parametrize("case", CASES)
def test_a_disturbance_is_met_by_the_physical_load_and_leaves_nothing_behind(bench: Bench, case: str) -> None:
    ours, theirs = both(bench, wiping(bench, **CASES[case]))
    mode = ours("load_mode")
    assert (mode[1000:BEGIN] == NETWORK).all()  # the motor has started
    during = mode[BEGIN:END]
    assert (during != NETWORK).mean() > 0.5, "the disturbance is outside the training"
    known = ("supply_v" in CASES[case]) or ("relay_on" in CASES[case] and "brake" not in str(CASES[case]))
    if not known:
        assert during[0] != NETWORK, "in the very tick"
    assert (mode[END + 1500 :] == NETWORK).all(), "and the network comes back for good"
    assert set(mode) <= {NETWORK, STANDSTILL, OUTSIDE}
    # bounded error against the physical plant, throughout and after it
    span = np.ptp(theirs("current_a"))
    current = ours("current_a") - theirs("current_a")
    assert np.sqrt(np.mean(current**2)) < 0.03 * span
    assert np.abs(ours("crank_speed_rad_s") - theirs("crank_speed_rad_s"))[-1000:].max() < 0.25


@pytest.mark.parametrize("case", CASES)
def test_no_hand_over_makes_the_motion_jump(bench: Bench, case: str) -> None:
    """The step in current, speed and angle at a hand-over is not larger than those that the physical plant makes."""
    ours, theirs = both(bench, wiping(bench, **CASES[case]))
    at = np.flatnonzero(np.diff((ours("load_mode") == NETWORK).astype(int)))
    assert len(at) >= 2
    for name, slack in (("current_a", 0.05), ("motor_speed_rad_s", 0.5)):
        for tick in at:
            around = slice(max(0, tick - 100), tick + 100)
            allowed = 1.2 * np.abs(np.diff(theirs(name)[around])).max() + slack
            assert np.abs(np.diff(ours(name)))[tick - 1 : tick + 2].max() <= allowed, (name, tick)
    turned = np.remainder(np.diff(ours("crank_angle_rad")), 2.0 * np.pi)
    middle = 0.5 * (ours("crank_speed_rad_s")[1:] + ours("crank_speed_rad_s")[:-1]) * bench.parameters.step_s
    assert np.abs(turned - middle)[at].max() < 1e-3


def test_the_torque_that_is_shown_is_within_the_promised_bound_of_the_physical_one(bench: Bench) -> None:
    """From the state of every tenth tick of a run, one tick of each; the inertia of both is that of the table."""
    file = bench.plant.load_file
    assert isinstance(file, TorqueFile)
    inputs = wiping(bench)
    state = initial_state(bench.parameters, bench.initial)
    shown, reduced = bench.parameter_row, bench.parameter_row.copy()
    reduced[PARAMETER_INDEX["load.model"]] = LOADS.index("reduced")
    row, outputs, checked = np.empty((1, len(OUTPUTS))), np.empty((1, len(OUTPUTS))), 0
    for tick in range(0, 4000, 10):
        simulate_rows(state.copy(), inputs[tick : tick + 1], shown, bench.tables, row)
        simulate_rows(state.copy(), inputs[tick : tick + 1], reduced, bench.tables, outputs)
        if row[0, OUTPUT_INDEX["load_mode"]] == NETWORK:
            away = abs(row - outputs)[0, OUTPUT_INDEX["load_torque_n_m"]]
            assert away <= file.bounds.dry_n_m
            assert away > 0.0
            checked += 1
        simulate_rows(state, inputs[tick : tick + 10], shown, bench.tables, np.empty((10, len(OUTPUTS))))
    assert checked > 250


def test_speed_hands_over_at_the_ends_of_the_training_with_hysteresis(bench: Bench) -> None:
    low, high = bench.plant.load_file.scaling.speed_rad_s  # type: ignore[union-attr]
    margin, ratio = 0.02 * (high - low), bench.parameters.motor.gear_ratio
    inputs = np.tile(bench.input_row, (1, 1))
    expected = {
        (low - 0.01, NETWORK): STANDSTILL, (low + 0.5 * margin, NETWORK): NETWORK,
        (low + 0.5 * margin, STANDSTILL): STANDSTILL, (low + 1.5 * margin, STANDSTILL): NETWORK,
        (high + 0.01, NETWORK): OUTSIDE, (high - 0.5 * margin, NETWORK): NETWORK,
        (high - 0.5 * margin, OUTSIDE): OUTSIDE, (high - 1.5 * margin, OUTSIDE): NETWORK,
        (-3.0, NETWORK): STANDSTILL, (0.0, NETWORK): STANDSTILL,
    }  # fmt: skip
    for (speed, before), wanted in expected.items():
        state = initial_state(bench.parameters, bench.initial | {"motor_speed_rad_s": speed * ratio})
        state[STATE_INDEX["load_mode"]] = before
        outputs = np.empty((1, len(OUTPUTS)))
        simulate_rows(state, inputs, bench.parameter_row, bench.tables, outputs)
        assert outputs[0, OUTPUT_INDEX["load_mode"]] == wanted, (speed, before)


def test_what_is_not_a_number_stops_the_motor_and_no_network_answers(bench: Bench) -> None:
    inputs = wiping(bench)
    inputs[BEGIN, INPUT_INDEX["supply_v"]] = np.nan
    ours, _ = both(bench, inputs)
    assert (ours("guard")[BEGIN:] == 1.0).all() and (ours("load_mode")[BEGIN:] != NETWORK).all()
    assert np.isfinite(ours("load_torque_n_m")).all()


def test_ten_minutes_of_mixed_wiping_park_as_often_and_as_well(bench: Bench) -> None:
    """Half-minute cycles of slow, fast and off, dry and wet by turns, at three supplies: twenty stops in park."""
    parking = bench.parameters.park_switch._replace(circuit=float(CIRCUITS.index("mechanical")))
    parameters = bench.parameters._replace(park_switch=parking)
    bench = replace(bench, parameters=parameters, parameter_row=pack(parameters))
    cycle = np.tile(bench.input_row, (30_000, 1))
    cycle[2_000:22_000, INPUT_INDEX["relay_on"]] = 1.0
    cycle[12_000:22_000, INPUT_INDEX["relay_fast"]] = 1.0
    blocks = []
    for number in range(20):
        block = cycle.copy()
        block[:, INPUT_INDEX["screen"]] = number % 2
        block[:, INPUT_INDEX["supply_v"]] = (11.0, 13.5, 16.0)[number % 3]
        blocks.append(block)
    ours, theirs = both(bench, np.concatenate(blocks))
    assert (ours("load_mode") == NETWORK).mean() > 0.6
    closings = [int((np.diff(run("park_contact")) > 0.5).sum()) for run in (ours, theirs)]
    assert closings[0] == closings[1] > 200
    ends = slice(29_999, None, 30_000)
    assert (ours("motor_speed_rad_s")[ends] == 0.0).all() and (ours("park_contact")[ends] == 1.0).all()
    away = np.remainder(ours("crank_angle_rad")[ends] - theirs("crank_angle_rad")[ends] + np.pi, 2 * np.pi) - np.pi
    assert np.degrees(np.abs(away)).max() < 1.0
    error = ours("current_a") - theirs("current_a")
    print(f"park within {np.degrees(np.abs(away)).max():.3f} deg, current RMS {np.sqrt(np.mean(error**2)):.3f} A")
    assert np.sqrt(np.mean(error**2)) < 0.03 * np.ptp(theirs("current_a"))
