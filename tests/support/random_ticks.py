"""Ticks from anywhere: states and inputs inside their ranges, far outside them, and what is not finite."""

import ctypes

import numpy as np
from numpy.typing import NDArray

from hilplant.bench import Bench
from hilplant.declaration import declared
from hilplant.models.plant import tick
from hilplant.models.records import State
from hilplant.signals import INPUTS, OUTPUTS
from hilplant.units import TURN_RAD

Rows = NDArray[np.float64]

#: How a moving wiper is spread: current, speed of the motor shaft, and the memory of the motor network.
_SPREAD = {"current_a": 8.0, "motor_speed_rad_s": 250.0, "terminal_v": 14.0, "torque_n_m": 20.0, "speed_rad_s": 5.0}
_WHOLE = {"park_contact": 2, "bounce_left": 6, "guard": 2, "park_phase": 3, "brush": 3, "mode": 4, "load_mode": 4}
_ODD = (0.0, -0.0, 1.0, -1.0, 1e-310, 1e30, -1e30, 1e300, np.inf, -np.inf, np.nan)


def random_states(count: int, random: np.random.Generator) -> Rows:
    """Return states [count, states]: of a wiper that moves, of one at rest, and one in twenty with odd numbers."""
    names = [signal.name.split(".")[-1] for signal in declared(State)]
    rows = np.empty((count, len(names)))
    for column, name in enumerate(names):
        if name == "crank_angle_rad":
            rows[:, column] = random.uniform(0.0, TURN_RAD, count)
        elif name in _WHOLE:
            rows[:, column] = random.integers(0, _WHOLE[name], count) * (random.random(count) < 0.5)
        else:
            rows[:, column] = random.normal(0.0, _SPREAD.get(name, 1.0), count) * (random.random(count) < 0.8)
    guard = names.index("guard")
    rows[:, guard] *= random.random(count) < 0.1
    return _with_odd_numbers(rows, random)


def random_inputs(bench: Bench, count: int, random: np.random.Generator) -> Rows:
    """Return inputs [count, inputs]: the bench's own, some drawn from their range or twice as far, some odd."""
    rows = np.tile(bench.input_row, (count, 1))
    for column, signal in enumerate(INPUTS):
        low, high = max(signal.minimum, -100.0), min(signal.maximum, 100.0)
        drawn = random.uniform(low - 0.5 * (high - low), high + 0.5 * (high - low), count)
        whole = random.integers(int(low), int(high) + 1, count)
        kind = random.integers(0, 3, count)
        rows[:, column] = np.choose(kind, [rows[:, column], drawn, whole.astype(float)])
    calm = random.random(count) < 0.5
    rows[calm, 3:] = bench.input_row[3:]
    return _with_odd_numbers(rows, random)


def by_ticks(bench: Bench, states: Rows, inputs: Rows, in_c: ctypes.CDLL | None = None, plant: object = None) -> Rows:
    """Return outputs and following state of each tick, by the compiled step or by the library in C."""
    results = np.full((len(states), len(OUTPUTS) + states.shape[1]), np.nan)
    for result, state, row in zip(results, states, inputs, strict=True):
        after, outputs = result[len(OUTPUTS) :], result[: len(OUTPUTS)]
        after[:] = state
        if in_c is None:
            tick(after, row, bench.parameter_row, bench.tables, outputs)
        else:
            in_c.hilplant_tick(plant, *(ctypes.c_void_p(each.ctypes.data) for each in (after, row, outputs)))
    return results


def _with_odd_numbers(rows: Rows, random: np.random.Generator) -> Rows:
    for column in rows.T:
        odd = random.random(len(rows)) < 0.05 / rows.shape[1]
        column[odd] = random.choice(_ODD, odd.sum())
    return rows
