"""Which experiment would tell what the data do not: each is simulated with what was found, and judged beforehand.

The derivatives of the imagined recording are put below those of the real ones; what is told then follows to first
order.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.failure import Failure
from hilplant.identify.experiment import Run
from hilplant.identify.local_search import Solution
from hilplant.identify.parameters import Choice, search_space
from hilplant.identify.residuals import LeastSquares, directions
from hilplant.identify.run_of_data import make_run
from hilplant.identify.twin import CLEAN, TwinCondition, corrupted, played
from hilplant.identify.uncertainty import LEAST, NORMAL_95, Identifiability
from hilplant.models.load import LOADS
from hilplant.models.records import PARAMETER_INDEX
from hilplant.signals import INPUT_INDEX
from hilplant.units import SECOND_NS

#: How well a spring balance tells the arm's force, in parts of it.
SPRING_BALANCE = 0.02
_VOLTS = (8.0, 12.0, 16.0)


class Experiment(NamedTuple):
    """Something that could be recorded or measured beside what there is."""

    text: str
    conditions: tuple[TwinCondition, ...] = ()
    force_factor: float = 1.0
    linkage: bool = True
    force_known: bool = False


class Advice(NamedTuple):
    """An experiment, and the parameters that it would tell beyond those that are told."""

    text: str
    tells: tuple[str, ...]


_BOTH = (TwinCondition(False, 0.0, _VOLTS), TwinCondition(True, 1.0, _VOLTS))
_SINGLE = (
    Experiment("starts at 8, 12, 16 V, slow on a dry screen", (TwinCondition(False, 0.0, _VOLTS),)),
    Experiment("starts at 8, 12, 16 V, fast on a dry screen", (TwinCondition(True, 0.0, _VOLTS),)),
    Experiment("starts at 8, 12, 16 V, slow on a wet screen", (TwinCondition(False, 1.0, _VOLTS),)),
    Experiment("starts at 8, 12, 16 V, fast on a wet screen", (TwinCondition(True, 1.0, _VOLTS),)),
    Experiment("starts, slow and dry, fast and wet, with the arm's force doubled by a known weight", _BOTH, 2.0),
    Experiment("the motor without linkage, slow and fast, at 8, 12, 16 V", _BOTH, linkage=False),
)
_FORCE = Experiment("the arm's force, with a spring balance to 2 %", force_known=True)


def advice(bench: Bench, solution: Solution, said: Sequence[Identifiability]) -> list[Advice]:
    """Return the experiments that would tell something more, each alone, and each together with the arm's force."""
    untold = {verdict.name for verdict in said if not verdict.identifiable}
    if not untold:
        return []
    found = [(each, _rows_of(bench, solution, each)) for each in (_FORCE, *_SINGLE)]
    usable = [(each, rows) for each, rows in found if rows is not None]
    given: list[Advice] = []
    seen: dict[str, set[str]] = {}
    for each, rows in usable:
        seen[each.text] = _told(solution, [rows]) & untold
        given.append(Advice(each.text, _ordered(solution, seen[each.text])))
    force = next((rows for each, rows in usable if each is _FORCE), None)
    for each, rows in usable:
        if force is not None and each is not _FORCE:
            both = _told(solution, [force, rows]) & untold
            if both - seen[each.text] - seen[_FORCE.text]:
                given.append(Advice(f"{_FORCE.text}, and {each.text}", _ordered(solution, both)))
    return [each for each in given if each.tells]


def _ordered(solution: Solution, names: set[str]) -> tuple[str, ...]:
    return tuple(name for name in solution.problem.choice.names if name in names)


def _told(solution: Solution, more: list[Floats]) -> set[str]:
    """Return what is told when rows [residuals, parameters] are put below the derivatives."""
    problem, count = solution.problem, solution.problem.parameters
    stacked = np.vstack([solution.jacobian, *(np.pad(rows, ((0, 0), (0, len(solution.x) - count))) for rows in more)])
    _, size, vectors = np.linalg.svd(np.linalg.qr(stacked, mode="r"))
    errors = np.sqrt(np.sum((vectors.T / np.maximum(size, LEAST)) ** 2, axis=1))[:count]
    low, high = search_space(problem.choice, solution.values)
    told = 2.0 * NORMAL_95 * errors < 0.5 * (high - low) / problem.scale[:count]
    return {name for name, yes in zip(problem.choice.names, told, strict=True) if yes}


def _rows_of(bench: Bench, solution: Solution, what: Experiment) -> Floats | None:
    """Return what an experiment says of the parameters, without its own offset and start; None if it cannot be made."""
    problem, count = solution.problem, solution.problem.parameters
    if what.force_known:
        if "force_n" not in problem.choice.names:
            return None
        place = problem.choice.names.index("force_n")
        row = np.zeros((1, count))
        row[0, place] = problem.scale[place] / (SPRING_BALANCE * solution.values[place])
        return row
    choice = problem.choice.without((), solution.values)
    if not what.linkage:
        base = choice.base_row.copy()
        base[PARAMETER_INDEX["load.model"]] = LOADS.index("none")
        choice = Choice(choice.parameters, base)
    try:
        runs = _imagined(bench, choice.base_row, what)
    except Failure:
        return None  # the wiper does not come round
    own = LeastSquares(runs, choice, problem.tables, problem.noise, problem.scale[:count])
    return _without_nuisance(own, own.start(solution.values))


def _imagined(bench: Bench, row: Floats, what: Experiment) -> list[Run]:
    inputs = bench.input_row.copy()
    inputs[[INPUT_INDEX["left_force"], INPUT_INDEX["right_force"]]] = what.force_factor
    other = replace(bench, parameter_row=row, input_row=inputs)
    step_s = bench.step_ns / SECOND_NS
    return [make_run(corrupted(played(other, each), CLEAN, step_s, 0), other, each.screen) for each in what.conditions]


def _without_nuisance(problem: LeastSquares, x: Floats) -> Floats:
    """Return the derivatives by the parameters, less what offsets and starts could explain."""
    moved = problem.moved
    jacobian = problem.jacobian(x)
    for _ in range(2):  # each time in better directions
        jacobian = problem.jacobian(x, directions(jacobian[:, moved]))
    own, nuisance = jacobian[:, : problem.parameters], jacobian[:, problem.parameters :]
    explained, _ = np.linalg.qr(nuisance)
    return np.asarray(np.linalg.qr(own - explained @ (explained.T @ own), mode="r"), np.float64)
