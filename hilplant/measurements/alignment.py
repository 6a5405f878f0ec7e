"""Offset of the current and shift in time between channels, estimated from the data and said.

The current cannot answer a step of the voltage before it comes, nor later than at once: after a step at time 0 it is
i = i0 + drift t + A (exp(-t/tau_m) - exp(-t/tau_e)) as (5.7) has it with its slow part in front. So the steps show by
how much the current's channel is late. The park switch has no such tie to the others: its shift cannot be told.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from hilplant.arrays import Flags, Floats, Whole

#: The window about a step in which the current's answer is looked at [s].
BEFORE_S, AFTER_S = 0.025, 0.04
#: How long a motor brakes at most, once it is off [s].
REST_S = 0.4
#: A step is this much of the voltage's range at least.
STEP_PART = 0.05
#: Shifts that are looked for, either way [s].
MOST_SHIFT_S = 0.02


class DelayEstimate(NamedTuple):
    """A value, its standard error, and from how much data it came."""

    value: float
    error: float
    samples: int


def rest_offset(values: Floats, voltage_v: Floats, period_s: float) -> DelayEstimate | None:
    """Return the mean of a channel while the motor rests with its terminals at 0 V; None when it never does."""
    rest = resting(voltage_v, period_s)
    count = int(np.count_nonzero(rest))
    if count * period_s < 0.1:
        return None
    return DelayEstimate(float(np.mean(values[rest])), float(np.std(values[rest]) / np.sqrt(count)), count)


def resting(voltage_v: Floats, period_s: float) -> Flags:
    """Say where the motor rests with its terminals at 0 V.

    There the terminal voltage has been below 2 % of the highest for `REST_S`, or since the file began: braking is over
    by then.
    """
    off = np.abs(voltage_v) < 0.02 * float(np.max(np.abs(voltage_v)))
    places = np.arange(len(off))
    last_on = np.maximum.accumulate(np.where(off, -len(off), places))
    return np.asarray(off & ((places - last_on) * period_s > REST_S), np.bool_)


def voltage_steps(voltage_v: Floats, period_s: float) -> list[int]:
    """Return the first sample after each jump of the voltage between two levels that hold for a while."""
    jump = np.abs(np.diff(voltage_v))
    height = STEP_PART * float(np.ptp(voltage_v))
    candidates = np.flatnonzero(jump > height) + 1
    before, after = round(BEFORE_S / period_s), round(AFTER_S / period_s)
    candidates = candidates[(candidates > before) & (candidates + after < len(voltage_v))]
    spreads = np.maximum(
        _spreads(voltage_v, candidates - before, before - 1), _spreads(voltage_v, candidates + 1, after - 1)
    )
    steps = []
    for index in candidates[~(spreads >= 0.11 * float(np.ptp(voltage_v)))]:  # ripple has many that are none
        left, right = voltage_v[index - before : index - 1], voltage_v[index + 1 : index + after]
        level = float(np.median(right) - np.median(left))
        still = max(float(np.std(left)), float(np.std(right)))
        if abs(level) > height and still < 0.1 * abs(level):
            steps.append(int(index))
    return [step for place, step in enumerate(steps) if place == 0 or step - steps[place - 1] > 2]


def _spreads(values: Floats, begins: Whole, count: int) -> Floats:
    """Return the standard deviation of `count` values from each of some places on."""
    about = values - np.mean(values)
    sums, squares = (np.concatenate([[0.0], np.cumsum(about**power)]) for power in (1, 2))
    means, seconds = ((total[begins + count] - total[begins]) / count for total in (sums, squares))
    return np.asarray(np.sqrt(np.maximum(seconds - means**2, 0.0)), np.float64)


def current_shift(current_a: Floats, voltage_v: Floats, period_s: float) -> DelayEstimate | None:
    """Return by how much [s] the current's channel is late against the voltage's; None without three clear steps.

    Shift and both time constants are common to all steps; offset, drift and height are each step's own (separable
    least squares). The standard error comes from the residuals.
    """
    steps = _clear_steps(current_a, voltage_v, period_s)
    if len(steps) < 3:
        return None
    before, after = round(BEFORE_S / period_s), round(AFTER_S / period_s)
    time_s = np.arange(-before, after) * period_s
    windows = [current_a[step - before : step + after] for step in steps]

    def residuals(shape: Floats) -> Floats:
        basis = _basis(time_s - shape[0], np.exp(shape[1]), np.exp(shape[2]))
        return np.concatenate([window - basis @ np.linalg.lstsq(basis, window, rcond=None)[0] for window in windows])

    grid = np.linspace(-MOST_SHIFT_S, MOST_SHIFT_S, 41)
    starts = [np.array([shift, np.log(0.003), np.log(0.03)]) for shift in grid]
    start = min(starts, key=lambda shape: float(np.sum(residuals(shape) ** 2)))
    low = [-1.2 * MOST_SHIFT_S, np.log(period_s / 5), np.log(0.004)]
    fit = least_squares(residuals, start, bounds=(low, [1.2 * MOST_SHIFT_S, np.log(0.02), np.log(1.0)]), diff_step=1e-3)
    freedom = max(1, len(fit.fun) - 3 * len(windows) - 3)
    covariance = np.linalg.pinv(fit.jac.T @ fit.jac) * float(np.sum(fit.fun**2)) / freedom
    return DelayEstimate(float(fit.x[0]), float(np.sqrt(covariance[0, 0])), len(steps))


def _clear_steps(current_a: Floats, voltage_v: Floats, period_s: float) -> list[int]:
    """Keep the steps that the current answers well above its noise."""
    before, after = round(BEFORE_S / period_s), round(AFTER_S / period_s)
    noise = 1.4826 * float(np.median(np.abs(np.diff(current_a)))) / np.sqrt(2.0)
    clear = []
    for step in voltage_steps(voltage_v, period_s):
        window = current_a[step - before : step + after]
        if np.ptp(window) > max(8.0 * noise, 1e-9):
            clear.append(step)
    return clear


def _basis(time_s: Floats, electrical_s: float, mechanical_s: float) -> Floats:
    after = np.maximum(time_s, 0.0)
    answer = np.exp(-after / mechanical_s) - np.exp(-after / electrical_s)
    return np.column_stack([np.ones_like(time_s), time_s, answer])
