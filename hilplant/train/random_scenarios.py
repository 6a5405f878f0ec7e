"""Random runs of a wiper: relays, supply, screen, and everything that a torque network was not trained for."""

import numpy as np

from hilplant.arrays import Floats
from hilplant.signals import INPUT_INDEX, INPUTS
from hilplant.units import TURN_RAD

#: How long one state of the inputs lasts [s], at least and at most.
SHORTEST_S, LONGEST_S = 0.1, 2.5

#: How often an ordinary stretch is followed by something out of the ordinary, and is off.
STRANGE, OFF = 0.4, 0.25


def random_inputs(seed: int, seconds: float, step_s: float, defaults: Floats) -> Floats:
    """Return rows of inputs [ticks, inputs]: ordinary wiping, with faults, weather and weak batteries in between."""
    random = np.random.default_rng(seed)
    ticks = round(seconds / step_s)
    rows = np.empty((ticks, len(INPUTS)))
    at, row = 0, defaults.copy()
    while at < ticks:
        length = max(1, min(ticks - at, round(random.uniform(SHORTEST_S, LONGEST_S) / step_s)))
        row = _ordinary(random, defaults)
        block = np.tile(row, (length, 1))
        if random.random() < STRANGE:
            _strange(random, block)
        rows[at : at + length] = block
        at += length
    return rows


def random_state(seed: int) -> tuple[float, float]:
    """Return an angle of the crank [rad] and a speed of the motor [rad/s] to start from; often at rest in park."""
    random = np.random.default_rng([seed, 1])
    if random.random() < 0.5:
        return 0.0, 0.0
    return float(random.uniform(0.0, TURN_RAD)), float(random.choice([0.0, random.uniform(-100.0, 600.0)]))


def _ordinary(random: np.random.Generator, defaults: Floats) -> Floats:
    row = defaults.copy()
    row[INPUT_INDEX["relay_on"]] = float(random.random() >= OFF)
    row[INPUT_INDEX["relay_fast"]] = float(random.random() < 0.5)
    row[INPUT_INDEX["supply_v"]] = random.uniform(9.0, 16.5)
    row[INPUT_INDEX["screen"]] = float(random.random() < 0.5)
    return row


def _strange(random: np.random.Generator, block: Floats) -> None:
    """Change a block of rows: over- or undervoltage, ramps, stalls, water, wind, wear, forces."""
    kind = random.integers(8)
    ramp = np.linspace(0.0, 1.0, len(block))
    supply, screen = block[:, INPUT_INDEX["supply_v"]], block[:, INPUT_INDEX["screen"]]
    if kind == 0:
        supply[:] = random.choice([0.0, 5.0, 25.0, random.uniform(0.0, 40.0)])
    elif kind == 1:
        supply += (random.uniform(0.0, 26.0) - supply) * ramp
    elif kind == 2:
        screen[:] = random.uniform(0.0, 1.0) if random.random() < 0.5 else ramp
    elif kind == 3:
        block[:, INPUT_INDEX["vehicle_speed_m_s"]] = random.uniform(0.0, 60.0) * ramp
    elif kind == 4:
        block[:, INPUT_INDEX["brake_torque_n_m"]] = random.choice([5.0, 1000.0, random.uniform(0.0, 60.0)])
    elif kind == 5:
        side = random.choice(["left", "right"])
        block[:, INPUT_INDEX[f"{side}_screen"]] = random.choice([0.0, 0.5, 1.0])
    elif kind == 6:
        block[:, INPUT_INDEX[f"{random.choice(['left', 'right'])}_wear"]] = random.uniform(0.0, 3.0)
    else:
        block[:, INPUT_INDEX[f"{random.choice(['left', 'right'])}_force"]] = random.uniform(0.0, 3.0)
