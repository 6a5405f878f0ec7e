"""Where stage 3 ended from other starts: a place that the data allow as well belongs to what is said.

A profile follows one valley. Two searches that end in different ones, neither better than the data can tell, show that
an interval about either alone would be too narrow.
"""

from collections.abc import Sequence

import numpy as np

from hilplant.identify.local_search import Solution
from hilplant.identify.parameters import search_space
from hilplant.identify.profile import ConfidenceInterval
from hilplant.identify.uncertainty import RISE_95, Identifiability, Spread

Said = tuple[list[Identifiability], list[ConfidenceInterval]]


def with_other_ends(solution: Solution, others: Sequence[Solution], known: Spread, said: Said) -> Said:
    """Return verdicts and intervals of the best solution, widened to where the others ended and the data allow it.

    A parameter whose interval is then wider than half of its search space is not identifiable (5.22).
    """
    found, intervals = list(said[0]), list(said[1])
    low, high = search_space(solution.problem.choice, solution.values)
    for other in others:
        rise = _rise(solution, other)
        for place, (verdict, interval) in enumerate(zip(found, intervals, strict=True)):
            if not verdict.identifiable or rise > RISE_95 * solution.variance * known.widening[place]:
                continue
            wider = _with(interval, float(other.values[place]))
            ends = [end if end is not None else verdict.value for end in wider]
            if ends[1] - ends[0] < 0.5 * (high[place] - low[place]):
                intervals[place] = wider
            else:
                found[place], intervals[place] = verdict._replace(identifiable=False), ConfidenceInterval(None, None)
    return found, intervals


def _rise(solution: Solution, other: Solution) -> float:
    """Return by how much the sum of squares of the best one is lower, both with its weights."""
    problem = solution.problem
    residuals = problem.residuals(other.x * other.problem.scale / problem.scale)
    return float(np.sum(residuals**2) - np.sum(solution.residuals**2))


def _with(interval: ConfidenceInterval, value: float) -> ConfidenceInterval:
    low, high = interval
    return ConfidenceInterval(None if low is None else min(low, value), None if high is None else max(high, value))
