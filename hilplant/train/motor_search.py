"""A search for the inputs at which the motor network is active and far from the physical motor.

Each tick of a scenario is taken twice from the same state, by the network with its guard and by the physical model;
the difference counts where the network was active. The scenarios go far beyond the training: 0 to 30 V, blocked
cranks, wind, worn blades, chattering relays, and any speed, current and angle at the start.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.jit import compiled_for_threads
from hilplant.models.narx import NETWORK
from hilplant.models.plant import step
from hilplant.models.records import Parameters, State
from hilplant.models.row import pack, unpack
from hilplant.signals import INPUT_INDEX, Inputs
from hilplant.units import TURN_RAD

#: Length of a scenario in ticks.
TICKS = 300


@dataclass(frozen=True, slots=True)
class OneTickErrors:
    """The largest differences that a search found, and where: scenario and tick of each."""

    scenarios: int
    ticks: int
    share_in_charge: float
    current_a: float
    current_at: tuple[int, int]
    crank_speed_rad_s: float
    speed_at: tuple[int, int]
    rms_current_a: float
    rms_crank_speed_rad_s: float


@compiled_for_threads
def differences(state_row: Any, input_rows: Any, parameter_rows: Any, tables: Any, found: Any) -> None:
    """Run a scenario by `parameter_rows[1]`, each tick also by `parameter_rows[0]` from the same state.

    `found` takes the largest difference in current and its tick, the same in motor speed, both sums of squares, and
    the ticks in which the network was active.
    """
    state = unpack(State, state_row)
    for index in range(7):
        found[index] = 0.0
    for tick in range(input_rows.shape[0]):
        inputs, before, physical = unpack(Inputs, input_rows[tick]), state, state
        for which in range(2):
            state, _ = step(before, inputs, unpack(Parameters, parameter_rows[which]), tables)
            if which == 0:
                physical = state
        if state.memory.mode == NETWORK:
            current, speed = state.current_a - physical.current_a, state.motor_speed_rad_s - physical.motor_speed_rad_s
            if not abs(current) <= found[0]:
                found[0], found[1] = abs(current), tick
            if not abs(speed) <= found[2]:
                found[2], found[3] = abs(speed), tick
            found[4] += current * current
            found[5] += speed * speed
            found[6] += 1.0


def wild_scenario(bench: Bench, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Return a state to begin with, and rows of inputs that nobody would wish a wiper."""
    speed, current = random.uniform(-120.0, 600.0), random.uniform(-15.0, 20.0)
    at_rest = random.random() < 0.3
    state = State(
        current_a=0.0 if at_rest else current,
        motor_speed_rad_s=0.0 if at_rest else speed,
        crank_angle_rad=random.uniform(0.0, TURN_RAD),
    )
    rows = np.tile(bench.input_row, (TICKS, 1))
    most_v, most_n_m = random.choice([14.0, 18.0, 25.0, 30.0]), random.choice([0.0, 10.0, 40.0, 500.0])
    drawn: dict[str, Callable[[], float]] = {
        "relay_on": lambda: float(random.random() < 0.8),
        "relay_fast": lambda: float(random.random() < 0.5),
        "supply_v": lambda: random.uniform(0.0, most_v),
        "brake_torque_n_m": lambda: random.uniform(0.0, most_n_m),
        "screen": lambda: random.choice([0.0, 0.5, 1.0, random.random()]),
        "vehicle_speed_m_s": lambda: random.choice([0.0, random.uniform(0.0, 60.0)]),
        "left_wear": lambda: random.choice([1.0, random.uniform(0.0, 3.0)]),
        "right_force": lambda: random.choice([1.0, random.uniform(0.0, 3.0)]),
    }
    for name, draw in drawn.items():
        column, first = rows[:, INPUT_INDEX[name]], 0
        longest = random.choice([2, 10, 60, TICKS])
        while first < TICKS:
            last = first + int(random.integers(1, longest + 1))
            begin, end = draw(), draw()
            ramp = name in ("supply_v", "brake_torque_n_m") and random.random() < 0.3
            shape = np.linspace(begin, end, last - first)[: TICKS - first]
            column[first:last] = shape if ramp else begin
            first = last
    return pack(state), rows


def search(bench: Bench, networks: Floats, scenarios: int, seed: int) -> OneTickErrors:
    """Try that many scenarios; scenario k is ``wild_scenario(bench, default_rng([seed, k]))``."""
    own = bench.parameters._replace(networks=networks)
    parameters = np.stack([pack(own._replace(motor_model=0.0)), pack(own._replace(motor_model=1.0))])

    def tried(k: int) -> Floats:
        state, rows = wild_scenario(bench, np.random.default_rng([seed, k]))
        result = np.empty(7)
        differences(state, rows, parameters, bench.tables, result)
        return result

    with ThreadPoolExecutor(2) as pool:
        found = np.array(list(pool.map(tried, range(scenarios))))
    at_current, at_speed, ticks = int(found[:, 0].argmax()), int(found[:, 2].argmax()), max(1.0, found[:, 6].sum())
    ratio = bench.parameters.motor.gear_ratio
    return OneTickErrors(
        scenarios,
        int(ticks),
        float(ticks / (scenarios * TICKS)),
        float(found[at_current, 0]),
        (at_current, int(found[at_current, 1])),
        float(found[at_speed, 2] / ratio),
        (at_speed, int(found[at_speed, 3])),
        float(np.sqrt(found[:, 4].sum() / ticks)),
        float(np.sqrt(found[:, 5].sum() / ticks) / ratio),
    )
