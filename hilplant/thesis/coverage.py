"""Whether the intervals keep their word: the last stage over many noises, each from a start that is off (twin data)."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.identify.experiment import Run
from hilplant.identify.local_search import search
from hilplant.identify.parameters import Choice, chosen
from hilplant.identify.profile import ConfidenceInterval, profile
from hilplant.identify.residuals import LeastSquares, expected_noise
from hilplant.identify.run_of_data import make_run
from hilplant.identify.twin import Corruption, TwinCondition, recorded
from hilplant.identify.uncertainty import spread, verdicts


class Trial(NamedTuple):
    """One noise: what was told, whether its interval holds the truth, and errors in units of the standard error."""

    seed: int
    told: dict[str, bool]
    inside: dict[str, bool]
    errors: dict[str, float]


class Coverage(NamedTuple):
    """How often each parameter was told, and how often its 95 % interval then held the truth.

    `mean` and `deviation` are those of its errors in units of the standard error: 0 and 1 where all is right.
    """

    trials: int
    told: dict[str, int]
    inside: dict[str, int]
    mean: dict[str, float]
    deviation: dict[str, float]


def twin_runs(bench: Bench, conditions: Sequence[TwinCondition], how: Corruption, seed: int) -> list[Run]:
    """Return what identification gets of one seed: its own start and switching in each recording, its own noise."""
    return [
        make_run(recorded(bench, condition, how, 1000 * seed + index), bench, condition.screen)
        for index, condition in enumerate(conditions)
    ]


def off_start(choice: Choice, seed: int, part: float) -> Floats:
    """Return every value off by this part of itself, up or down at random."""
    signs = np.random.default_rng([seed, 20]).choice([-1.0, 1.0], len(choice))
    return np.asarray(choice.values * (1.0 + part * signs), np.float64)


def trial(bench: Bench, runs: Sequence[Run], seed: int, part: float = 0.2) -> Trial:
    """Run the last stage alone, with no knowledge of the truth but a start that is off by `part`."""
    choice = chosen(bench.parameter_row)
    start = off_start(choice, seed, part)
    found = search(LeastSquares(runs, choice, bench.tables, expected_noise(runs), np.abs(start)), start)
    known = spread(found)
    said = verdicts(found, known)
    truth = dict(zip(choice.names, choice.values, strict=True))
    intervals = zip(said, profile(found, known, said), strict=True)
    return Trial(
        seed,
        {each.name: each.identifiable for each in said},
        {each.name: each.identifiable and holds(interval, truth[each.name]) for each, interval in intervals},
        {each.name: (each.value - truth[each.name]) / each.standard_error for each in said},
    )


def holds(interval: ConfidenceInterval, value: float) -> bool:
    """Say whether a value lies inside; a side that is open holds everything."""
    return bool((interval.low is None or interval.low <= value) and (interval.high is None or value <= interval.high))


def trials(
    bench: Bench, conditions: Sequence[TwinCondition], how: Corruption, seeds: Iterable[int],
    done: Callable[[Trial], None] = lambda _: None,
) -> list[Trial]:  # fmt: skip
    """Run a trial for each seed."""
    found = []
    for seed in seeds:
        found.append(trial(bench, twin_runs(bench, conditions, how, seed), seed))
        done(found[-1])
    return found


def coverage(found: Sequence[Trial]) -> Coverage:
    """Count over trials."""
    told: Counter[str] = Counter()
    inside: Counter[str] = Counter()
    for each in found:
        for name, is_told in each.told.items():
            told[name] += is_told
            inside[name] += each.inside[name]
    errors = {name: np.array([each.errors[name] for each in found]) for name in told}
    mean = {name: float(np.mean(values)) for name, values in errors.items()}
    deviation = {name: float(np.std(values)) for name, values in errors.items()}
    return Coverage(len(found), dict(told), dict(inside), mean, deviation)
