"""How far a bench is from recordings: what `hilplant validate` and held-out data say."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.identify.experiment import Run, simulate_run
from hilplant.identify.local_search import search
from hilplant.identify.parameters import Choice
from hilplant.identify.residuals import LeastSquares, edge_errors_s, expected_noise


class RunError(NamedTuple):
    """One recording against the model: errors of the current [A] and of the park edges [s].

    `noise_a` is the recording's own restlessness from sample to sample, below which no model comes. Where the crank
    stood at the start and the offset of the current are not errors of the bench: both were fitted.
    """

    name: str
    rms_current_a: float
    worst_current_a: float
    mean_current_a: float
    noise_a: float
    rms_edge_s: float
    start_rad: float
    offset_a: float


class Comparison(NamedTuple):
    """A recording, and what the model makes of it."""

    run: Run
    error: RunError
    simulated_a: Floats
    park_steps: Floats
    edge_errors_s: Floats


#: Up to this many times its noise what is left of the current is explained by it.
EXPLAINED = 1.2


def unexplained(compared: Sequence[Comparison]) -> list[str]:
    """Return a line for each recording whose current the model does not explain: intervals would be too narrow."""
    return [
        f"{each.name}: the current's error is {each.rms_current_a / each.noise_a:.1f} times the noise: the model does "
        "not explain it, so intervals are withheld; try --also coulomb_torque_n_m, or look at the data"
        for each in (comparison.error for comparison in compared)
        if each.rms_current_a > EXPLAINED * each.noise_a > 0.0
    ]


def compare(runs: Sequence[Run], row: Floats, tables: Floats) -> list[Comparison]:
    """Hold parameters against recordings; only start and offset of each are fitted."""
    return [_compared(run, row, tables) for run in runs]


def _compared(run: Run, row: Floats, tables: Floats) -> Comparison:
    noise = expected_noise([run])
    nothing = np.zeros(0)
    found = search(LeastSquares([run], Choice([], row), tables, noise, nothing), nothing)
    offset, start = (found.x * found.problem.scale)[:2]
    made = simulate_run(run, row[np.newaxis], np.array([start]), tables)
    current = made.current_a[0] + offset
    errors = (current - run.current_a)[run.valid]
    late = edge_errors_s(found.problem.localised(found.x).runs[0], made.phase_rad)[0]  # by the speed at each edge
    error = RunError(
        run.name, _rms(errors), float(np.max(np.abs(errors))), float(np.mean(np.abs(run.current_a[run.valid]))),
        noise.current_a, _rms(late), float(start), float(offset),
    )  # fmt: skip
    return Comparison(run, error, current, made.park_steps[0], late)


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))
