"""How often a bench wipes and what it draws, over supply, screen and stage, beside what FMVSS 104 demands.

The rule (49 CFR 571.104, S4.1.1) asks for two frequencies: one of at least 45 cycles a minute, one of at least 20, and
15 between the highest and one of the others.
"""

from dataclasses import dataclass

import numpy as np

from hilplant.bench.assembly import Bench, initial_state
from hilplant.signals import INPUT_INDEX
from hilplant.simulation.batch import simulate_batch
from hilplant.simulation.crank_torque import WETNESS
from hilplant.units import SECOND_NS, TURN_RAD

SUPPLIES_V = (9.0, 10.0, 11.0, 12.0, 13.0, 13.5, 14.0, 15.0, 16.0)
SCREENS = ("wet", "dry")
STAGES = ("slow", "fast")

#: FMVSS 104: least cycles a minute of the fast and of the slow frequency, and between them.
FAST_AT_LEAST, SLOW_AT_LEAST, APART_AT_LEAST = 45.0, 20.0, 15.0

#: Supply at which the rule is looked at, and cycles a minute that an integration of Table 5-9 without our code gave.
RULE_SUPPLY_V = 13.5
INDEPENDENT = {"slow": 39.2, "fast": 50.2}

#: Seconds that are left for the start, and that are looked at.
START_S, LOOKED_AT_S = 3.0, 27.0
_SHOWN = ("current_a", "crank_angle_rad")


@dataclass(frozen=True, slots=True)
class Wiping:
    """Cycles a minute, mean and highest current [A] over whole cycles, in steady wiping."""

    supply_v: float
    screen: str
    stage: str
    cycles_per_minute: float
    mean_current_a: float
    peak_current_a: float


@dataclass(frozen=True, slots=True)
class Demand:
    """One of the rule's figures beside ours, in cycles a minute."""

    what: str
    at_least: float
    found: float

    @property
    def met(self) -> bool:
        """Whether it is reached."""
        return self.found >= self.at_least


def wiping(bench: Bench, supplies_v: tuple[float, ...] = SUPPLIES_V) -> list[Wiping]:
    """Return what the bench does at each supply, on each screen, in each stage."""
    cases = [(supply, screen, stage) for supply in supplies_v for screen in SCREENS for stage in STAGES]
    first, ticks = (round(seconds * SECOND_NS / bench.step_ns) for seconds in (START_S, START_S + LOOKED_AT_S))
    inputs = np.stack([np.tile(_row(bench, *case), (ticks, 1)) for case in cases])
    states = np.tile(initial_state(bench.parameters, bench.initial), (len(cases), 1))
    parameters = np.tile(bench.parameter_row, (len(cases), 1))
    shown = simulate_batch(states, inputs, parameters, bench.tables, _SHOWN)
    step_s = bench.step_ns / SECOND_NS
    return [Wiping(*case, *_steady(shown[index, first:], step_s)) for index, case in enumerate(cases)]


def demands(table: list[Wiping], supply_v: float, screen: str = "wet") -> list[Demand]:
    """Return the rule's figures beside those at one supply on one screen."""
    fast, slow = (
        next(
            row.cycles_per_minute for row in table if (row.supply_v, row.screen, row.stage) == (supply_v, screen, stage)
        )
        for stage in ("fast", "slow")
    )
    return [
        Demand("fast", FAST_AT_LEAST, fast),
        Demand("slow", SLOW_AT_LEAST, slow),
        Demand("apart", APART_AT_LEAST, fast - slow),
    ]


def _row(bench: Bench, supply_v: float, screen: str, stage: str) -> np.ndarray:
    row = bench.input_row.copy()
    values = {"relay_on": 1.0, "relay_fast": float(stage == "fast"), "supply_v": supply_v, "screen": WETNESS[screen]}
    for name, value in values.items():
        row[INPUT_INDEX[name]] = value
    return row


def _steady(shown: np.ndarray, step_s: float) -> tuple[float, float, float]:
    """Return cycles a minute, mean and highest current over the whole turns of a run; 0 cycles when it stands."""
    current, angle = shown.T
    turned = np.unwrap(angle, period=TURN_RAD)
    turns = int((turned[-1] - turned[0]) / TURN_RAD)
    if turns < 1:
        return 0.0, float(current.mean()), float(current.max())
    last = int(np.searchsorted(turned, turned[0] + turns * TURN_RAD))
    before, after = turned[last - 1], turned[last]
    part = (turned[0] + turns * TURN_RAD - before) / (after - before)
    minutes = (last - 1 + part) * step_s / 60.0
    return float(turns / minutes), float(current[:last].mean()), float(current[:last].max())
