"""The whole way: measurements and a bench in, parameters with their intervals out (5.3 to 5.6)."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.identify.advice import Advice, advice
from hilplant.identify.cost import Cost, cost_of
from hilplant.identify.executor import Executor, evaluator, here
from hilplant.identify.experiment import Run
from hilplant.identify.forces import FrictionForce, friction_forces
from hilplant.identify.genetic import Evaluate, Generation, OnGeneration, Outcome, SearchSettings, Space, order_of
from hilplant.identify.local_search import Solution, search
from hilplant.identify.optimisers import budget, optimiser
from hilplant.identify.other_ends import with_other_ends
from hilplant.identify.parameters import Choice, search_space
from hilplant.identify.profile import ConfidenceInterval, profile
from hilplant.identify.residuals import LeastSquares, expected_noise
from hilplant.identify.stages import ALL, GLOBAL_SEARCH, StagedValues, no_search
from hilplant.identify.uncertainty import Identifiability, Spread, spread, verdicts
from hilplant.identify.validation import EXPLAINED, Comparison, compare, unexplained
from hilplant.models.load import REDUCED
from hilplant.models.records import PARAMETER_INDEX
from hilplant.progress import OnProgress, ProgressReport, unseen

_TABLE_5_7 = SearchSettings()
_UNSETTLED = (
    "stage 3 was still getting better when its rounds were over, so intervals are withheld; go on from what was found: "
    "the same command with the written bench as --bench and --stages 3"
)


@dataclass(frozen=True, slots=True)
class Task:
    """What is to be found, from what, and how.

    `about` are the values about which the search space is laid; `journal` wraps the evaluation so that a killed run can
    go on.
    """

    bench: Bench
    runs: Sequence[Run]
    choice: Choice
    about: Floats
    held_out: Sequence[Run] = ()
    settings: SearchSettings = _TABLE_5_7
    seed: int = 0
    search: str = "genetic"
    ordered: bool = True
    executor: Executor = here
    journal: Callable[[Evaluate], Evaluate] = field(default=lambda evaluate: evaluate)
    on_progress: OnProgress = unseen
    stages: tuple[int, ...] = ALL


class Times(NamedTuple):
    """How long each part took [s], and how many simulations of all recordings it made."""

    global_s: float
    global_evaluations: int
    global_computed: int  # less those that a journal answered
    local_s: float
    local_evaluations: int
    intervals_s: float

    @property
    def journal_note(self) -> str:
        """How many evaluations were answered by the journal of an earlier run, and so took no time."""
        answered = self.global_evaluations - self.global_computed
        return f"{answered} of them from the journal of an earlier run" if answered > 0 else ""

    @property
    def evaluations_per_s(self) -> float:
        """Simulations of all recordings that the search made in a second."""
        return self.global_computed / max(self.global_s, 1e-9)


class Identified(NamedTuple):
    """What identification found; `row` is the bench's packed row with the new parameters."""

    task: Task
    cost: Cost
    space: Space
    outcome: Outcome
    solution: Solution
    known: Spread
    verdicts: list[Identifiability]
    intervals: list[ConfidenceInterval]
    forces: list[FrictionForce]
    advice: list[Advice]
    row: Floats
    fitted: list[Comparison]
    held_out: list[Comparison]
    times: Times
    final_cost: float

    @property
    def unexplained(self) -> list[str]:
        """A line for each fitted recording that the model does not explain."""
        return unexplained(self.fitted)

    @property
    def withheld(self) -> list[str]:
        """Why no interval is told: a line for each reason, none where all is well."""
        return self.unexplained + ([] if self.solution.settled else [_UNSETTLED])

    @property
    def told_intervals(self) -> dict[str, ConfidenceInterval]:
        """95 % intervals by name of what is identifiable; none at all where they are withheld."""
        if self.withheld:
            return {}
        told = zip(self.verdicts, self.intervals, strict=True)
        return {verdict.name: interval for verdict, interval in told if verdict.identifiable}


def identify_partly(task: Task) -> StagedValues:
    """Run stage 2 alone, or none: what stage 1 says is `task.about`. Nothing is said of how sure the values are."""
    began_s = time.perf_counter()
    cost, space, computed = _search_parts(task)
    outcome = _searched(task, cost, space, computed)
    row = task.choice.rows(outcome.values[np.newaxis])[0]
    tables = task.bench.tables
    return StagedValues(
        outcome.values, outcome.cost, outcome if GLOBAL_SEARCH in task.stages else None, row,
        compare(task.runs, row, tables), compare(task.held_out, row, tables), time.perf_counter() - began_s,
    )  # fmt: skip


def _search_parts(task: Task) -> tuple[Cost, Space, "_Computed"]:
    cost = cost_of(task.runs, task.choice, task.bench.tables)
    low, high = search_space(task.choice, task.about)
    space = Space(low, high, order_of(task.choice.names) if task.ordered else ())
    return cost, space, _Computed(evaluator(cost, task.executor))


def _searched(task: Task, cost: Cost, space: Space, computed: "_Computed") -> Outcome:
    """Return what stage 2 finds; without it, the place where it would have begun."""
    if GLOBAL_SEARCH not in task.stages:
        return no_search(cost, task.about)
    return optimiser(task.search)(task.journal(computed), space, task.settings, task.seed, _search_progress(task))


def identify(task: Task) -> Identified:
    """Run stage 2, unless it is left out, and stage 3, and tell how sure the result is."""
    clock = [time.perf_counter()]
    cost, space, computed = _search_parts(task)
    outcome = _searched(task, cost, space, computed)
    clock.append(time.perf_counter())
    solution, *others = refined(task, outcome)
    clock.append(time.perf_counter())
    known = spread(solution)
    first = verdicts(solution, known)
    said, intervals = with_other_ends(solution, others, known, (first, profile(solution, known, first)))
    clock.append(time.perf_counter())
    row = task.choice.rows(solution.values[np.newaxis])[0]
    spent = np.diff(clock)
    times = Times(
        float(spent[0]),
        outcome.history[-1].evaluations,
        computed.count,
        float(spent[1]),
        solution.evaluations,
        float(spent[2]),
    )
    return Identified(
        task, cost, space, outcome, solution, known, said, intervals,
        friction_forces(solution, known) if has_wiper(task.bench) else [],
        advice(task.bench, solution, said) if has_wiper(task.bench) else [], row,
        compare(task.runs, row, task.bench.tables), compare(task.held_out, row, task.bench.tables), times,
        float(cost(solution.values[np.newaxis])[0]),
    )  # fmt: skip


def has_wiper(bench: Bench) -> bool:
    """Say whether a bench has blades with friction to find; without them it is a motor alone (section 5.4.5)."""
    return bench.parameters.load.model == REDUCED


def _search_progress(task: Task) -> OnGeneration:
    """Return what tells of each generation; the search is complete when its budget of evaluations is spent."""
    total = budget(task.settings)

    def tell(seen: Generation) -> None:
        note = f"lowest cost {seen.best:.4g}, {seen.evaluations} evaluations"
        task.on_progress(ProgressReport("search", seen.evaluations, total, note))

    return tell


class _Computed:
    """Counts what is computed and not answered from a journal."""

    def __init__(self, evaluate: Evaluate) -> None:
        self.evaluate, self.count = evaluate, 0

    def __call__(self, sets: Floats) -> Floats:
        self.count += len(sets)
        return self.evaluate(sets)


def refined(task: Task, outcome: Outcome) -> list[Solution]:
    """Search on from where stage 2 ended; while that leaves the current unexplained, from the next start as well.

    Once it is explained, search again with that motor and the friction known beforehand: one end alone may stand in a
    valley of its own, where friction at low speed and its rate stand in for each other. The best end comes first.
    """
    motor = np.array([parameter.place < PARAMETER_INDEX["load.model"] for parameter in task.choice.parameters])
    mixed = np.where(motor, outcome.values, task.about)
    solutions: list[Solution] = []
    # Stage 2 may end where the force's factor of (4.50) is below 0: no friction, so no derivative says which way out.
    for values in (outcome.values, mixed, task.about):
        solutions.append(_end_from(task, values))
        if solutions[-1].noise.current_a < EXPLAINED * expected_noise(task.runs).current_a:
            again = np.where(motor, solutions[-1].values, task.about)
            if not np.array_equal(values[~motor], again[~motor]):
                solutions.append(_end_from(task, again))
            break
    return sorted(solutions, key=lambda solution: solution.noise.current_a)


def _end_from(task: Task, values: Floats) -> Solution:
    """Search from values, and tell of each round."""
    refining = ProgressReport("refine", budget(task.settings), budget(task.settings))

    def refined_to(left_a: float) -> None:
        task.on_progress(refining._replace(note=f"current {left_a:.4g} A rms"))

    scale = np.maximum(np.abs(values), 0.01 * np.array([parameter.usual for parameter in task.choice.parameters]))
    problem = LeastSquares(task.runs, task.choice, task.bench.tables, expected_noise(task.runs), scale)
    return search(problem, values, refined_to)
