"""Whatever happened before: once switched off each circuit parks, and no switching adds energy."""

import math
from typing import Any

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from hilplant.models.plant import simulate_rows, tick
from hilplant.models.records import Arm, Brush, Load, Motor, Parameters, ParkSwitch, State
from hilplant.models.row import pack
from hilplant.models.tables import POINTS
from hilplant.signals import OUTPUTS, Inputs, Outputs
from hilplant.units import TURN_RAD

MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.045, 63.0)
LOADS = (Load(0.0), Load(1.0, 0.0035, 0.2738))
TABLES = np.zeros((9, POINTS + 2, 2))
DIGITAL, MECHANICAL, DEPRESSED = 0.0, 1.0, 2.0
PARKED = 2.0
LONGEST_WAY_S = 8.0  # of one turn with slow brush and load, from a stop, and the way back
Rows = NDArray[np.float64]


def parameters(circuit: float, load: Load, switch: tuple[float, float, float]) -> Parameters:
    park_rad, bounce_ticks, reverse_rad = switch
    park_switch = ParkSwitch(park_rad, 0.122, 0.009, bounce_ticks, circuit, reverse_rad)
    return Parameters(1e-3, MOTOR, park_switch, load, Arm(0.0, 0.5), Arm(0.0, 0.5))


PARAMETERS = st.builds(
    parameters,
    st.sampled_from((DIGITAL, MECHANICAL, DEPRESSED)),
    st.sampled_from(LOADS),
    st.tuples(st.floats(0.0, TURN_RAD, exclude_max=True), st.integers(0, 6).map(float), st.floats(0.05, 1.0)),
)
#: The rest of the state keeps its defaults.
STATES = st.tuples(
    st.floats(-10.0, 10.0),
    st.floats(-350.0, 350.0),
    st.floats(0.0, TURN_RAD, exclude_max=True),
    st.sampled_from((0.0, 1.0)),
    st.integers(0, 6).map(float),
    st.just(0.0),
    st.sampled_from((0.0, 1.0, 2.0)),
).map(lambda given: State(*given))
FLAG = st.sampled_from((0.0, 1.0))
COMMANDS = st.tuples(FLAG, FLAG, st.floats(0.0, 16.0), st.just(0.0) | st.floats(0.0, 60.0))
INPUTS = COMMANDS.map(lambda given: Inputs(given[0], given[1], given[2], 0.0, 0.0, given[3]))
HISTORY = st.lists(st.tuples(INPUTS, st.integers(1, 300)), max_size=6)


def rows(history: list[tuple[Inputs, int]]) -> Rows:
    return np.concatenate([np.tile(pack(inputs), (ticks, 1)) for inputs, ticks in history])


def rest(state: Rows, chosen: Parameters, fast: float) -> Any:
    """Return the outputs of the last tick of a long time with the relays off."""
    ticks = round(LONGEST_WAY_S / chosen.step_s)
    outputs = np.empty((ticks, len(OUTPUTS)))
    off = Inputs(0.0, fast, 13.5, 0.0, 0.0, 0.0)
    simulate_rows(state, rows([(off, ticks)]), pack(chosen), TABLES, outputs)
    return Outputs(*outputs[-1])


@settings(max_examples=300, deadline=None)
@given(chosen=PARAMETERS, start=STATES, history=HISTORY, fast=FLAG)
def test_switched_off_every_circuit_comes_to_rest_and_parks(
    chosen: Parameters, start: State, history: list[tuple[Inputs, int]], fast: float
) -> None:
    state, switch = pack(start), chosen.park_switch
    if history:
        past = rows(history)
        simulate_rows(state, past, pack(chosen), TABLES, np.empty((len(past), len(OUTPUTS))))
    phase_before = state[6]
    last = rest(state, chosen, fast)
    assert (last.motor_speed_rad_s, last.terminal_v, last.guard) == (0.0, 0.0, 0.0)
    assert abs(last.current_a) < 1e-6
    if switch.circuit == MECHANICAL:
        assert last.park_contact == 1.0
    if switch.circuit == DEPRESSED:
        assert (state[6], last.terminal_53_v, last.terminal_31_v, last.terminal_53e_v) == (PARKED, 0.0, 0.0, 0.0)
    if switch.circuit == DEPRESSED and phase_before == 0.0:
        back = (switch.angle_rad - switch.half_window_rad - last.crank_angle_rad) % TURN_RAD
        coasting = 0.5 * MOTOR.inertia_kg_m2 * 350.0**2 / MOTOR.coulomb_torque_n_m / MOTOR.gear_ratio
        assert switch.reverse_angle_rad <= back <= switch.reverse_angle_rad + coasting


@settings(max_examples=200, deadline=None)
@given(chosen=PARAMETERS, start=STATES, history=HISTORY)
def test_no_switching_adds_energy_that_the_battery_did_not_give(
    chosen: Parameters, start: State, history: list[tuple[Inputs, int]]
) -> None:
    """The charge of a step follows from (3.30): V dt = L di + R q + K turned; V q is what the battery gave."""
    assume(history)
    past = rows(history)
    row, output, packed = pack(start), np.empty(len(OUTPUTS)), pack(chosen)
    for inputs in past:
        before = row.copy()
        tick(row, inputs, packed, TABLES, output)
        seen = Outputs(*output)
        brush = (
            MOTOR.fast if inputs[1] > 0.5 and (inputs[0] > 0.5 or chosen.park_switch.circuit == DIGITAL) else MOTOR.slow
        )
        turned = MOTOR.gear_ratio * math.remainder(row[2] - before[2], TURN_RAD)
        flux = brush.inductance_henry * (row[0] - seen.current_a) + brush.constant_v_s * turned
        charge = (seen.terminal_v * chosen.step_s - flux) / brush.resistance_ohm
        given_j = seen.terminal_v * charge if seen.terminal_v else 0.0
        assert abs(seen.current_a) <= abs(before[0])
        gained_j = stored(row[0], row[1], brush) - stored(seen.current_a, before[1], brush)
        size = stored(row[0], row[1], brush) + stored(before[0], before[1], brush) + abs(given_j)
        assert gained_j <= given_j + 1e-9 * size + 1e-15


def stored(current_a: float, speed_rad_s: float, brush: Brush) -> float:
    return 0.5 * brush.inductance_henry * current_a**2 + 0.5 * MOTOR.inertia_kg_m2 * speed_rad_s**2
