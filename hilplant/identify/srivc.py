"""Coefficients of (5.7) from sampled data, in continuous time: simplified refined instrumental variables (SRIVC).

Young and Jakeman (1980); Garnier and Wang, "Identification of Continuous-time Models from Sampled Data" (2008),
chapter 4. Voltage and current run through the filter 1/A(s), so that derivatives are filter states and not differences.
The regression uses the model's own current as instrument, so noise of the current does not bend the result; filter and
instrument are renewed until nothing changes. There, the output error is orthogonal to its own gradient.

Beyond the thesis: any state at the start of a stretch is allowed for, and a constant torque (dry friction) may act
while the motor turns: J dw/dt = K i - (b + gamma) w - T gives a third coefficient c = K T/(L J).
"""

import warnings
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.signal import BadCoefficients, cont2discrete, lfilter

from hilplant.failure import Failure
from hilplant.identify.transfer_function import TransferFunction
from hilplant.measurements.measurement import Mask, Samples

#: Rounds until the relative change of all coefficients is below the tolerance; after the cap a search takes over.
ROUNDS, TOLERANCE = 40, 1e-7
#: The filter of the first round is 1/(s + FIRST_POLE)^2 [1/s]: between the two time constants of a wiper motor.
FIRST_POLE_1_S = 150.0
#: Errors are taken as correlated within a block of this length, and independent between blocks [s].
BLOCK_S = 0.25


class Stretch(NamedTuple):
    """Samples without a gap, in one mode: voltage (held between samples), current, and which samples count."""

    voltage_v: Samples
    current_a: Samples
    valid: Mask


class TransferFit(NamedTuple):
    """The coefficients, with their covariance in the order b1, b0, a1, a0 (, c)."""

    function: TransferFunction
    friction: float  # c = K T/(L J) [A/s^2]; 0 when not asked for
    covariance: NDArray[np.float64]
    residual_a: float  # root mean square of current minus model
    rounds: int


class _Columns(NamedTuple):
    """Filtered signals of one stretch."""

    voltage: NDArray[np.float64]  # s u/A, u/A (, 1/A of a unit step), and the two answers to a state at the start
    current: NDArray[np.float64]  # s y/A, y/A


def fit(stretches: Sequence[Stretch], period_s: float, friction: bool = False) -> TransferFit:
    """Estimate the transfer function from voltage to current.

    Raises
    ------
    Failure
        When the data cannot tell the coefficients apart; it says what would help.

    """
    model = np.array([2.0 * FIRST_POLE_1_S, FIRST_POLE_1_S**2])  # a1, a0
    theta: NDArray[np.float64] | None = None
    for count in range(1, ROUNDS + 1):
        last = theta
        theta = _round(stretches, period_s, friction, model, theta)
        model = _stable(theta[:2])
        if last is not None and np.max(np.abs(theta[: 4 + friction] / last[: 4 + friction] - 1.0)) < TOLERANCE:
            return _result(stretches, period_s, friction, theta, count)
    return _result(stretches, period_s, friction, _searched(stretches, period_s, friction), ROUNDS)


def _searched(stretches: Sequence[Stretch], period_s: float, friction: bool) -> NDArray[np.float64]:
    """Find the least output error by search over a1 and a0 where the rounds go in circles; the rest is linear.

    Where the rounds do settle, it is at the same place.
    """
    current = np.concatenate([stretch.current_a[stretch.valid] for stretch in stretches])

    def exogenous(logs: Samples) -> NDArray[np.float64]:
        rows = [_columns(stretch, period_s, friction, np.exp(logs)).voltage for stretch in stretches]
        wide = [_widened(row, place, len(rows)) for place, row in enumerate(rows)]
        return np.vstack([each[stretch.valid] for each, stretch in zip(wide, stretches, strict=True)])

    def misfit(logs: Samples) -> Samples:
        columns = exogenous(logs)
        return np.asarray(current - columns @ np.linalg.lstsq(columns, current, rcond=None)[0], np.float64)

    times = [(fast, slow) for fast in (0.002, 0.006) for slow in (0.01, 0.04)]
    starts = [np.log([1.0 / fast + 1.0 / slow, 1.0 / (fast * slow)]) for fast, slow in times]
    found = min((least_squares(misfit, start, diff_step=1e-4) for start in starts), key=lambda each: float(each.cost))
    if not found.success or np.any(found.x > np.log([1e5, 1e9])):
        raise Failure(
            "the transfer function cannot be told from these data: they excite the motor too little; record more steps "
            "of the voltage, switching on among them"
        )
    columns = exogenous(found.x)
    return np.concatenate([np.exp(found.x), np.linalg.lstsq(columns, current, rcond=None)[0]])


def simulated(function: TransferFunction, voltage_v: Samples, period_s: float) -> Samples:
    """Return the current [A] from rest for a voltage that is held between samples."""
    return _held(np.array([function.b1, function.b0]), np.array([function.a1, function.a0]), voltage_v, period_s)


def _round(
    stretches: Sequence[Stretch], period_s: float, friction: bool, model: Samples, theta: NDArray[np.float64] | None
) -> NDArray[np.float64]:
    """One regression with the filter 1/A of `model`; the first one, without a model's current, is least squares."""
    left, right = [], []
    rows = [_columns(stretch, period_s, friction, model) for stretch in stretches]
    for place, (stretch, columns) in enumerate(zip(stretches, rows, strict=True)):
        exogenous = _widened(columns.voltage, place, len(stretches))
        regressors = np.hstack([-columns.current, exogenous])
        instruments = regressors
        if theta is not None:
            modelled = exogenous @ theta[2:]
            instruments = np.hstack([-_filtered(modelled, model, period_s, held=False), exogenous])
        target = stretch.current_a - columns.current @ model
        left.append(instruments[stretch.valid].T @ regressors[stretch.valid])
        right.append(instruments[stretch.valid].T @ target[stretch.valid])
    return _solved(np.sum(left, axis=0), np.sum(right, axis=0))


def _solved(left: NDArray[np.float64], right: NDArray[np.float64]) -> NDArray[np.float64]:
    scale = np.sqrt(np.abs(np.diag(left)))
    if not np.all(np.isfinite(left)) or np.any(scale == 0.0):
        raise Failure("the transfer function cannot be told from these data: voltage or current does not change")
    scaled = left / np.outer(scale, scale)
    if np.linalg.cond(scaled) > 1e14:
        raise Failure("the transfer function cannot be told from these data: record steps of the voltage")
    solution: NDArray[np.float64] = np.linalg.solve(scaled, right / scale) / scale
    return solution


def _columns(stretch: Stretch, period_s: float, friction: bool, model: Samples) -> _Columns:
    count = len(stretch.current_a)
    blocks = [_filtered(stretch.voltage_v, model, period_s, held=True)]
    if friction:
        blocks.append(_filtered(np.ones(count), model, period_s, held=True)[:, 1:])
    blocks.append(_free_answers(count, model, period_s))
    return _Columns(np.hstack(blocks), _filtered(stretch.current_a, model, period_s, held=False))


def _widened(columns: NDArray[np.float64], place: int, stretches: int) -> NDArray[np.float64]:
    """Give each stretch its own two columns for the state at its start."""
    common = columns.shape[1] - 2
    wide = np.zeros((len(columns), common + 2 * stretches))
    wide[:, :common] = columns[:, :common]
    wide[:, common + 2 * place : common + 2 * place + 2] = columns[:, common:]
    return wide


def _filtered(values: Samples, model: Samples, period_s: float, held: bool) -> NDArray[np.float64]:
    """Return s/A and 1/A of a signal that is held between samples, or else is a straight line between them."""
    first = 0.0 if held else values[0]
    answers = [_held(numerator, model, values, period_s, held) for numerator in ([1.0, 0.0], [0.0, 1.0])]
    return np.column_stack(answers) if first == 0.0 else _from_level(values, model, period_s)


def _from_level(values: Samples, model: Samples, period_s: float) -> NDArray[np.float64]:
    """Filter a signal as if it had been at its first value for ever, so that no jump is seen at its start."""
    first = values[0]
    moved = [_held(numerator, model, values - first, period_s, False) for numerator in ([1.0, 0.0], [0.0, 1.0])]
    return np.column_stack([moved[0], moved[1] + first / model[1]])


def _held(
    numerator: Samples | list[float], model: Samples, values: Samples, period_s: float, held: bool = True
) -> Samples:
    """Return a signal behind numerator/A; it is held between samples, or else a straight line between them."""
    top, bottom = _discrete(tuple(numerator), tuple(model), period_s, held)
    return np.asarray(lfilter(top, bottom, values), np.float64)


@lru_cache(maxsize=64)
def _discrete(numerator: tuple[float, ...], model: tuple[float, ...], period_s: float, held: bool) -> tuple[Any, Any]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", BadCoefficients)  # a held input has a first coefficient of 0, as it must be
        top, bottom, _ = cont2discrete((numerator, (1.0, *model)), period_s, method="zoh" if held else "foh")
    return top.ravel(), bottom


def _free_answers(count: int, model: Samples, period_s: float) -> NDArray[np.float64]:
    """Return the answers of s/A and 1/A to an impulse at the start: what any state at the start decays with."""
    roots = np.roots([1.0, model[0], model[1]]).astype(complex)
    if abs(roots[0] - roots[1]) < 1e-6 * abs(roots[0]):
        roots[1] *= 1.0 + 1e-6
    times = np.arange(count) * period_s
    first, second = np.exp(roots[0] * times), np.exp(roots[1] * times)
    apart = roots[0] - roots[1]
    return np.column_stack([((roots[0] * first - roots[1] * second) / apart).real, ((first - second) / apart).real])


def _stable(denominator: Samples) -> Samples:
    """Mirror roots of the filter into the stable half plane, away from its edge."""
    roots = np.roots([1.0, denominator[0], denominator[1]])
    mirrored = -np.maximum(np.abs(roots.real), 0.1) + 1j * roots.imag
    polynomial = np.poly(mirrored).real
    return np.array([polynomial[1], polynomial[2]])


def _result(
    stretches: Sequence[Stretch], period_s: float, friction: bool, theta: NDArray[np.float64], count: int
) -> TransferFit:
    """Collect the coefficients and their covariance."""
    gradients, errors = [], []
    for place, stretch in enumerate(stretches):
        exogenous = _widened(_columns(stretch, period_s, friction, theta[:2]).voltage, place, len(stretches))
        modelled = exogenous @ theta[2:]
        gradient = np.hstack([-_filtered(modelled, theta[:2], period_s, held=False), exogenous])
        gradients.append(gradient[stretch.valid])
        errors.append((stretch.current_a - modelled)[stretch.valid])
    order = [2, 3, 0, 1, *([4] if friction else [])]
    covariance = _covariance(gradients, errors, period_s)[np.ix_(order, order)]
    function = TransferFunction(*(float(theta[index]) for index in order[:4]))
    residual_a = float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))
    return TransferFit(function, float(theta[4]) if friction else 0.0, covariance, residual_a, count)


def _covariance(
    gradients: Sequence[NDArray[np.float64]], errors: Sequence[Samples], period_s: float
) -> NDArray[np.float64]:
    """Return the covariance from sums over blocks, so that errors which hang together count; that of noise at least."""
    information = np.sum([gradient.T @ gradient for gradient in gradients], axis=0)
    inverse = np.linalg.pinv(information, rcond=1e-20, hermitian=True)
    noise = inverse * float(np.mean(np.concatenate(errors) ** 2))
    sums = []
    for gradient, error in zip(gradients, errors, strict=True):
        count = max(1, round(len(error) * period_s / BLOCK_S))
        sums += [block.sum(axis=0) for block in np.array_split(gradient * error[:, None], count)]
    scatter = np.array(sums)
    if len(sums) <= 2 * len(information):
        return noise
    blocks = inverse @ (scatter.T @ scatter) @ inverse * len(sums) / (len(sums) - len(information))
    widening = np.sqrt(np.maximum(1.0, np.diag(noise) / np.maximum(np.diag(blocks), 1e-300)))
    return np.asarray(blocks * np.outer(widening, widening), np.float64)
