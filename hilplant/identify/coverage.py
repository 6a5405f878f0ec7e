"""Whether the intervals keep their word: the last stage over many noises, each from a start that is off (twin data)."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from hilplant.bench import Bench
from hilplant.identify.experiment import Run
from hilplant.identify.local_search import search
from hilplant.identify.measurement import Samples
from hilplant.identify.parameters import Choice, chosen
from hilplant.identify.residuals import Problem, expected_noise
from hilplant.identify.run_of_data import make_run
from hilplant.identify.twin import Clean, Condition, Spoiling, played, spoilt
from hilplant.identify.uncertainty import NORMAL_95, spread, verdicts
from hilplant.units import SECOND_NS


class Trial(NamedTuple):
    """One noise: what was told, whether the truth lies inside, and errors in units of the standard error."""

    seed: int
    told: dict[str, bool]
    errors: dict[str, float]
    residual_a: float


class Coverage(NamedTuple):
    """How often each parameter was told, and how often the truth was then inside its 95 % interval."""

    trials: int
    told: dict[str, int]
    inside: dict[str, int]


def twin_runs(bench: Bench, plays: Sequence[tuple[Condition, Clean]], how: Spoiling, seed: int) -> list[Run]:
    """Return what identification gets: clean plays spoilt by this seed."""
    step_s = bench.step_ns / SECOND_NS
    return [
        make_run(spoilt(clean, how, step_s, 1000 * seed + place), bench, condition.screen)
        for place, (condition, clean) in enumerate(plays)
    ]


def plays_of(bench: Bench, conditions: Sequence[Condition], how: Spoiling) -> list[tuple[Condition, Clean]]:
    """Play each condition once; the noise comes later."""
    return [(condition, played(bench, condition, how)) for condition in conditions]


def off_start(choice: Choice, seed: int, part: float) -> Samples:
    """Return every value off by this part of itself, up or down at random."""
    signs = np.random.default_rng([seed, 20]).choice([-1.0, 1.0], len(choice))
    return np.asarray(choice.values * (1.0 + part * signs), np.float64)


def trial(bench: Bench, runs: Sequence[Run], seed: int, part: float = 0.2) -> Trial:
    """Run the last stage alone, with no knowledge of the truth but a start that is off by `part`."""
    choice = chosen(bench.parameter_row)
    start = off_start(choice, seed, part)
    found = search(Problem(runs, choice, bench.tables, expected_noise(runs), np.abs(start)), start)
    said = verdicts(found, spread(found))
    truth = dict(zip(choice.names, choice.values, strict=True))
    errors = {each.name: (each.value - truth[each.name]) / each.standard_error for each in said}
    return Trial(seed, {each.name: each.told for each in said}, errors, found.noise.current_a)


def trials(
    bench: Bench, conditions: Sequence[Condition], how: Spoiling, seeds: Iterable[int],
    done: Callable[[Trial], None] = lambda _: None,
) -> list[Trial]:  # fmt: skip
    """Run a trial for each seed."""
    plays = plays_of(bench, conditions, how)
    found = []
    for seed in seeds:
        found.append(trial(bench, twin_runs(bench, plays, how, seed), seed))
        done(found[-1])
    return found


def coverage(found: Sequence[Trial]) -> Coverage:
    """Count over trials."""
    told: Counter[str] = Counter()
    inside: Counter[str] = Counter()
    for each in found:
        for name, is_told in each.told.items():
            told[name] += is_told
            inside[name] += is_told and abs(each.errors[name]) <= NORMAL_95
    return Coverage(len(found), dict(told), dict(inside))
