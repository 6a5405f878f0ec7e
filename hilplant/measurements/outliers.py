"""Single samples that stand out from their neighbours: flagged and counted, their values left as they are."""

import numpy as np
from scipy.ndimage import maximum_filter1d, median_filter

from hilplant.arrays import Flags, Floats

#: Samples of the running median; a spike of up to two samples stands out against it.
WINDOW = 7
#: How many robust standard deviations a spike must stand out.
DEVIATIONS = 8.0
#: Around a step of the voltage the current may truly peak within a few samples [s].
TRANSIENT_S = 0.05


def spikes(values: Floats, spared: Flags | None = None) -> Flags:
    """Flag samples far from the median of their `WINDOW` neighbours (Hampel's rule, with one scale for the whole file).

    The scale is the median distance from the running median, at least a millionth of the values' range; a sample is
    compared with the largest distance nearby as well, so that what varies much everywhere is not flagged.
    """
    distance = np.abs(values - median_filter(values, WINDOW, mode="nearest"))
    scale = 1.4826 * max(float(np.median(distance)), 0.002 * float(np.ptp(np.percentile(values, [1, 99]))))
    flagged = distance > DEVIATIONS * max(scale, 1e-12)
    return np.asarray(flagged & ~spared if spared is not None else flagged, dtype=np.bool_)


def near_steps(values: Floats, period_s: float) -> Flags:
    """Say which samples lie within `TRANSIENT_S` of a jump of a voltage that stays."""
    before = median_filter(values, 5, mode="nearest", origin=2)
    after = median_filter(values, 5, mode="nearest", origin=-2)
    jump = np.abs(after - before) > max(0.3, 0.02 * float(np.ptp(values)))
    width = 2 * max(1, round(TRANSIENT_S / period_s)) + 1
    return np.asarray(maximum_filter1d(jump.astype(np.int8), width) > 0, dtype=np.bool_)
