"""From many samples to a few figures, and how two subjects are measured fairly beside each other."""

import math
from collections.abc import Callable, Mapping, Sequence
from statistics import median


def quantile(ordered: Sequence[float], share: float) -> float:
    """Return the least value that `share` of the `ordered` samples do not exceed (nearest rank)."""
    if not ordered:
        raise ValueError("no samples")
    return ordered[max(0, math.ceil(share * len(ordered)) - 1)]


def histogram_quantile(counts: Mapping[int, int], share: float) -> float:
    """Return the least value that `share` of the samples do not exceed; `counts` is by value."""
    wanted = share * sum(counts.values())
    seen = 0
    for value in sorted(counts):
        seen += counts[value]
        if seen >= wanted:
            return float(value)
    raise ValueError("no samples")


def alternate(rounds: int, *subjects: Callable[[], float]) -> list[list[float]]:
    """Measure A B A B ..., so that what the machine does meanwhile falls on all alike; one list for each."""
    results: list[list[float]] = [[] for _ in subjects]
    for _ in range(rounds):
        for subject, values in zip(subjects, results, strict=True):
            values.append(subject())
    return results


def middle(records: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the median of each figure over the rounds, and the greatest of those whose name says `max`."""
    return {name: (max if "max" in name else median)(record[name] for record in records) for name in records[0]}
