"""A current that ran into the limit of clamp or logger: flat at its extreme, entered at full slope."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.measurements.measurement import DataFinding, Measurement

#: How far before a plateau its slope is looked at [s], and samples that make a plateau without noise on it, with noise.
BEFORE_S, FEWEST, FEWEST_NOISY = 0.002, 3, 8
#: Noise that a clamp adds behind its own limit: height of the plateau, most scatter there, and most drift from its
#: first half to its second, in standard deviations.
NOISE_HEIGHT, NOISE_SCATTER, NOISE_DRIFT = 8.0, 1.4, 2.5
#: With more noise a peak of braking cannot be told from a limit [A].
MOST_NOISE_A = 0.15
#: A slope is told from the logger's steps when it rises by this many; coarse ones are above this part of the range.
QUANTA, COARSE_PART = 4.0, 0.002
#: A limit that is nearer to 0 than this part of the current's range is none: it is where a current ends that is off.
LEAST_PART = 0.1


class _Plateau(NamedTuple):
    """The samples of a limit: the highest, down to `height` below it; `rise` is that of the slope before.

    `noise` is the standard deviation of the noise on it, infinite where the samples need not be compared.
    """

    height: float
    rise: float
    fewest: int
    noise: float


def clipped(data: Measurement, native_period_s: float) -> Iterable[DataFinding]:
    """Find a current that runs into a limit; `native_period_s` is the distance of its own samples [s]."""
    stride = max(1, round(native_period_s / data.period_s))  # repeated values are no plateau
    current, time_s = data.current_a[::stride], data.time_s[::stride]
    before = max(2, round(BEFORE_S / (stride * data.period_s)))
    for sign, name in ((1.0, "above"), (-1.0, "below")):
        hits = _hits(sign * current, before)
        if hits:
            level = sign * float(np.median(np.concatenate([sign * current[hit] for hit in hits])))
            text = f"the current is cut off {name} {level:.4g} A, first at {time_s[hits[0].start]:.3f} s ({len(hits)} "
            text += "times): it left the range of clamp or logger; choose a larger range and record again"
            yield DataFinding("clipped_current", text)


def _hits(values: Floats, before: int) -> list[slice]:
    """Return the plateaus at the upper limit, exact ones, else those with noise on them."""
    span, top = float(np.ptp(values)), float(np.max(values))
    if span == 0.0 or top < LEAST_PART * span:
        return []
    noise = 1.4826 * float(np.median(np.abs(np.diff(values, n=2)))) / np.sqrt(6.0)
    height, step = NOISE_HEIGHT * noise, float(np.min(np.diff(np.unique(values))))
    fewest = FEWEST if step < COARSE_PART * span else FEWEST_NOISY  # a true peak is as flat as that within one step
    exact = _Plateau(1e-9 * span, max(0.02 * span, QUANTA * step), fewest, np.inf)
    noisy = _Plateau(height, min(4.0 * height, 0.5 * top), FEWEST_NOISY, noise)
    hits = _plateaus(values, exact, before) or (_plateaus(values, noisy, before) if 0.0 < noise < MOST_NOISE_A else [])
    return [hit for hit in hits if np.median(values[hit]) > LEAST_PART * span]


def _plateaus(values: Floats, wanted: _Plateau, before: int) -> list[slice]:
    low = float(np.max(values)) - wanted.height
    flat = np.concatenate([[0], (values >= low).astype(np.int8), [0]])
    starts, ends = np.flatnonzero(np.diff(flat) > 0), np.flatnonzero(np.diff(flat) < 0)
    return [
        slice(int(start), int(end))
        for start, end in zip(starts, ends, strict=True)
        if end - start >= wanted.fewest
        and start >= before
        and low - values[start - before] > wanted.rise
        and _level(values[start:end], wanted.noise)
    ]


def _level(values: Floats, noise: float) -> bool:
    """Say whether samples scatter as noise alone does, about a level that stays; without those at both ends."""
    if np.isinf(noise):
        return True
    inner = values[1:-1]
    first, second = inner[: len(inner) // 2], inner[len(inner) // 2 :]
    drift = abs(float(np.mean(first) - np.mean(second)))
    return bool(np.std(inner) <= NOISE_SCATTER * noise and drift <= NOISE_DRIFT * noise * 2.0 / np.sqrt(len(inner)))
