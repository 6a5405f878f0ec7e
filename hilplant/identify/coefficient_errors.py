"""Standard errors of fitted coefficients: noise of the current, of the voltage, and errors that hang together.

Noise of the measured voltage is no input of the motor, so the model answers to what the motor never saw: white noise of
the voltage stands in the errors as the model's answer to it, correlated over the motor's time constants.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Flags, Floats
from hilplant.identify.filters import held_answer

#: Errors are taken as correlated within a block of this length, and independent between blocks [s].
BLOCK_S = 0.25
#: The same where steps are few: some electrical time constants [s].
COLOUR_S = 0.01
#: Median of the absolute value of normal noise, in standard deviations.
MEDIAN_OF_NORMAL = 0.6745


class FittedStretch(NamedTuple):
    """One stretch after the fit: slopes of the current over the coefficients, its error [A], voltage [V], flags."""

    gradient: Floats
    error_a: Floats
    voltage_v: Floats
    valid: Flags

    def slopes(self) -> Floats:
        """Return the slopes of the samples that count."""
        return self.gradient[self.valid]

    def errors(self) -> Floats:
        """Return the errors of the samples that count [A]."""
        return self.error_a[self.valid]


class VoltageAnswer(NamedTuple):
    """The model from voltage to current: numerator b1, b0, denominator a1, a0, and the time between samples."""

    numerator: Floats
    denominator: Floats
    period_s: float

    def turned(self, values: Floats) -> Floats:
        """Return what each sample of the voltage adds to a weighted sum of the current's samples."""
        return held_answer(self.numerator, self.denominator, values[::-1], self.period_s)[::-1]


def covariance_of(fitted: Sequence[FittedStretch], model: VoltageAnswer) -> Floats:
    """Return the covariance from sums over blocks; that of independent errors at least."""
    gradients, errors = [each.slopes() for each in fitted], [each.errors() for each in fitted]
    information = np.sum([gradient.T @ gradient for gradient in gradients], axis=0)
    inverse = np.linalg.pinv(information, rcond=1e-20, hermitian=True)
    noise = inverse * float(np.mean(np.concatenate(errors) ** 2))
    sums = []
    for gradient, error in zip(gradients, errors, strict=True):
        count = max(1, round(len(error) * model.period_s / BLOCK_S))
        sums += [block.sum(axis=0) for block in np.array_split(gradient * error[:, None], count)]
    scatter = np.array(sums)
    if len(sums) <= 2 * len(information):
        return _of_few_steps(fitted, model)
    blocks = inverse @ (scatter.T @ scatter) @ inverse * len(sums) / (len(sums) - len(information))
    widening = np.sqrt(np.maximum(1.0, np.diag(noise) / np.maximum(np.diag(blocks), 1e-300)))
    return np.asarray(blocks * np.outer(widening, widening), np.float64)


def voltage_noise(fitted: Sequence[FittedStretch]) -> float:
    """Return the standard deviation of the voltage's noise [V]: the median change between samples, steps left aside."""
    changes = np.concatenate([np.abs(np.diff(each.voltage_v)) for each in fitted])
    return float(np.median(changes) / (MEDIAN_OF_NORMAL * np.sqrt(2.0)))


def _of_few_steps(fitted: Sequence[FittedStretch], model: VoltageAnswer) -> Floats:
    """Return the covariance from few steps: that of independent errors, widened in each direction of the fit.

    The wider of two counts. The one is what the noise of the voltage makes there, through the model. The other are the
    sums of the errors over blocks of `COLOUR_S`, beside what independent ones would give: a fit with as many
    coefficients as there are blocks has taken most of these away.
    """
    left, size, vectors = np.linalg.svd(np.vstack([each.slopes() for each in fitted]), full_matrices=False)
    error = np.concatenate([each.errors() for each in fitted])
    variance = float(np.sum(error**2)) / max(1, len(error) - len(size))
    block = max(1, round(COLOUR_S / model.period_s))
    ends = np.cumsum([len(each.errors()) for each in fitted])
    first = np.array([0, *ends[:-1]])
    starts = np.concatenate([np.arange(begin, end, block) for begin, end in zip(first, ends, strict=True)])
    sums = np.add.reduceat(left * error[:, np.newaxis], starts, axis=0)
    through, noise_v = variance * np.eye(len(size)), voltage_noise(fitted)
    for each, begin, end in zip(fitted, first, ends, strict=True):
        weights = np.zeros((len(each.valid), len(size)))
        weights[each.valid] = left[begin:end]
        turned = np.array([model.turned(weight) for weight in weights.T])
        through += noise_v**2 * turned @ turned.T
    wider = np.sqrt(np.maximum(1.0, np.sum(sums**2, axis=0) / np.diag(through)))
    scaled = vectors.T * (wider / np.maximum(size, 1e-10 * size[0]))
    return np.asarray(scaled @ through @ scaled.T, np.float64)
