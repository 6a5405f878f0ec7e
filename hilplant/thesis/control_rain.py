"""An hour of mixed rain: what continuous speed saves against two speeds in energy and brush wear.

Section 7.1 of Dooner (2016) argues that a wiper that turns no faster than the rain asks for needs less energy and wears
its brushes less; it measures neither. Here both drive the same plant through the same rain. The need is a wipe rate;
the two-speed ECU takes the slower of its two speeds that meets it, or fast when neither does. One with an intermittent
stage rests between slow wipes when less than the slow speed is needed.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench, initial_state
from hilplant.control.catalogue import without_network
from hilplant.control.closed_loop import TRACE, run_rows
from hilplant.control.records import POWER_ON, Controller
from hilplant.jit import uninterrupted
from hilplant.models.plant import simulate_rows
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, OUTPUTS
from hilplant.units import TURN_RAD

SECONDS = 3600
#: How long the need stays as it is [s].
PIECE_S = 30
#: How much of it is simulated [s]; its sums count for the whole.
SIMULATED_S = 15
#: Lowest and highest need [wipe cycles a minute].
LEAST_PER_MINUTE, MOST_PER_MINUTE = 20.0, 60.0
#: Of the converter that a variable voltage takes; assumed. Relays lose nothing.
CONVERTER_EFFICIENCY = 0.9
BATTERY_V = 13.5


class Duty(NamedTuple):
    """An hour's sums. Wear has two measures: turns of the motor, and the integral of the current squared."""

    energy_wh: float  # from the battery
    current_squared_a2_h: float
    motor_turns: float
    wipes: float
    peak_current_a: float
    missed: float  # part of the time in which the mean speed was more than 5 % below the need


def rain(seed: int = 3) -> Floats:
    """Return the need of each piece of the hour [cycles a minute]: a seeded walk between drizzle and downpour."""
    generator, level, needs = np.random.default_rng(seed), 0.3, []
    for _ in range(SECONDS // PIECE_S):
        level = float(np.clip(level + 0.05 * (0.4 - level) + generator.normal(0.0, 0.12), 0.0, 1.0))
        needs.append(LEAST_PER_MINUTE + level * (MOST_PER_MINUTE - LEAST_PER_MINUTE))
    return np.array(needs)


def wetness(need_per_minute: float) -> float:
    """Return how wet the screen is: 0.8, a little dry between wipes, at the least need, 1 at the highest."""
    part = (need_per_minute - LEAST_PER_MINUTE) / (MOST_PER_MINUTE - LEAST_PER_MINUTE)
    return 0.8 + 0.2 * part


def two_speed_duty(bench: Bench, needs: Floats, intermittent: bool = False) -> Duty:
    """Run the hour with relays: slow where that meets the need on a wet screen, else fast.

    An intermittent wipe is timed: on for as long as a slow turn takes on the driest screen of the hour, then off.
    """
    slow_rate, turn_s = _settled_rate(bench, 1.0), 60.0 / _settled_rate(bench, wetness(LEAST_PER_MINUTE))
    second = np.arange(_ticks(bench)) * bench.parameters.step_s

    def piece(state: Floats, rows: Floats, need: float, outputs: Floats) -> None:
        rests = intermittent and need * turn_s < 60.0
        rows[:, INPUT_INDEX["relay_on"]] = (second % (60.0 / need) < turn_s) if rests else 1.0
        rows[:, INPUT_INDEX["relay_fast"]] = float(need > slow_rate)
        rows[:, INPUT_INDEX["supply_v"]] = BATTERY_V
        simulate_rows(state, rows, bench.parameter_row, bench.tables, outputs)

    return _duty(bench, needs, piece, 1.0)


def controlled_duty(bench: Bench, needs: Floats, controller: Controller) -> Duty:
    """Run the hour at the speed that the rain asks for."""
    memory = POWER_ON
    trace = np.empty((_ticks(bench), len(TRACE)))
    tables = without_network()

    def piece(state: Floats, rows: Floats, need: float, outputs: Floats) -> None:
        nonlocal memory
        reference = np.full(len(rows), need * TURN_RAD / 60.0)
        plant = (state, bench.parameter_row, bench.tables)
        with uninterrupted():
            memory = run_rows(memory, controller, tables, plant, (rows, reference, outputs, trace))

    return _duty(bench, needs, piece, CONVERTER_EFFICIENCY)


def _ticks(bench: Bench) -> int:
    return round(SIMULATED_S / bench.parameters.step_s)


def _settled_rate(bench: Bench, wet: float) -> float:
    """Return the cycles a minute of the slow brush at the battery's voltage."""
    rows, outputs = np.tile(bench.input_row, (_ticks(bench), 1)), np.empty((_ticks(bench), len(OUTPUTS)))
    for name, value in (("relay_on", 1.0), ("supply_v", BATTERY_V), ("screen", wet)):
        rows[:, INPUT_INDEX[name]] = value
    simulate_rows(bench.state_row.copy(), rows, bench.parameter_row, bench.tables, outputs)
    return float(outputs[:, OUTPUT_INDEX["crank_speed_rad_s"]].mean() * 60.0 / TURN_RAD)


Piece = Callable[[Floats, Floats, float, Floats], None]


def _duty(bench: Bench, needs: Floats, piece: Piece, efficiency: float) -> Duty:
    step_s, ticks = bench.parameters.step_s, _ticks(bench)
    state = initial_state(bench.parameters, bench.initial)
    rows, outputs = np.tile(bench.input_row, (ticks, 1)), np.empty((ticks, len(OUTPUTS)))
    sums = np.zeros(4)
    peak = 0.0
    for need in needs:
        rows[:, INPUT_INDEX["screen"]] = wetness(need)
        piece(state, rows, float(need), outputs)
        names = ("terminal_v", "current_a", "crank_speed_rad_s")
        voltage, current, speed = (outputs[:, OUTPUT_INDEX[name]] for name in names)
        # what the armature returns when it brakes, below 0.002 Wh, is taken for lost
        energy = np.maximum(voltage * current, 0.0).sum()
        missed = (speed.mean() * 60.0 / TURN_RAD < 0.95 * need) * len(speed)
        sums += [energy / efficiency, (current**2).sum(), speed.sum(), missed]
        peak = max(peak, float(np.abs(current).max()))
    seconds = step_s * PIECE_S / SIMULATED_S
    hours = seconds / 3600.0
    turns = float(sums[2] * seconds / TURN_RAD)
    ratio = bench.parameters.motor.gear_ratio
    share = float(sums[3] / (ticks * len(needs)))
    return Duty(float(sums[0] * hours), float(sums[1] * hours), turns * ratio, turns, peak, share)
