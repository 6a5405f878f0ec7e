"""Coefficients of (5.7) from sampled data, in continuous time: simplified refined instrumental variables (SRIVC).

Young and Jakeman (1980); Garnier and Wang, "Identification of Continuous-time Models from Sampled Data" (2008),
chapter 4. Voltage and current run through the filter 1/A(s), so that derivatives are filter states and not differences.
The regression uses the model's own current as instrument, so noise of the current does not bend the result; filter and
instrument are renewed until nothing changes. There, the output error is orthogonal to its own gradient.

Beyond the thesis: any state at the start of a stretch is allowed for, and a constant torque (dry friction) may act
while the motor turns: J dw/dt = K i - (b + gamma) w - T gives a third coefficient c = K T/(L J). Before it turns, and
until the current is T/K, the shaft is held (`breakaway`).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from hilplant.arrays import Flags, Floats
from hilplant.failure import Failure
from hilplant.identify.breakaway import torque_part
from hilplant.identify.coefficient_errors import FittedStretch, VoltageAnswer, covariance_of
from hilplant.identify.filters import filtered, free_answers, held_answer, stable
from hilplant.identify.transfer_function import TransferFunction

#: Rounds until the relative change of all coefficients is below the tolerance; after the cap a search takes over.
ROUNDS, TOLERANCE = 40, 1e-7
#: Steps of a search, at most, and the largest a1 [1/s] and a0 [1/s^2] that it looks at.
MOST_STEPS, HIGHEST = 50, (1e5, 1e9)
#: The filter of the first round is 1/(s + FIRST_POLE)^2 [1/s]: between the two time constants of a wiper motor.
FIRST_POLE_1_S = 150.0


class Stretch(NamedTuple):
    """Samples without a gap, in one mode: voltage (held between samples), current, and which samples count.

    For the first `rest` samples the motor stands still at 0 V; 0: it turns.
    """

    voltage_v: Floats
    current_a: Floats
    valid: Flags
    rest: int = 0


class TransferFit(NamedTuple):
    """The coefficients, with their covariance in the order b1, b0, a1, a0 (, c)."""

    function: TransferFunction
    friction: float  # c = K T/(L J) [A/s^2]; 0 when not asked for
    covariance: Floats
    residual_a: float  # root mean square of current minus model
    rounds: int


class _Columns(NamedTuple):
    """Filtered signals of one stretch."""

    voltage: Floats  # s u/A, u/A (, 1/A of a unit step), and the two answers to a state at the start
    current: Floats  # s y/A, y/A


def fit(stretches: Sequence[Stretch], period_s: float, friction: bool = False) -> TransferFit:
    """Estimate the transfer function from voltage to current.

    Raises
    ------
    Failure
        When the data cannot tell the coefficients apart; it says what would help.

    """
    model = np.array([2.0 * FIRST_POLE_1_S, FIRST_POLE_1_S**2])  # a1, a0
    theta: Floats | None = None
    for count in range(1, ROUNDS + 1):
        last = theta
        theta = _round(stretches, period_s, friction, model, theta)
        model = stable(theta[:2])
        if last is not None and np.max(np.abs(theta[: 4 + friction] / last[: 4 + friction] - 1.0)) < TOLERANCE:
            return _result(stretches, period_s, friction, theta, count)
    return _result(stretches, period_s, friction, _searched(stretches, period_s, friction), ROUNDS)


def _searched(stretches: Sequence[Stretch], period_s: float, friction: bool) -> Floats:
    """Find the least output error by search over a1 and a0 where the rounds go in circles; the rest is linear.

    Where the rounds do settle, it is at the same place.
    """
    times = [(fast, slow) for fast in (0.002, 0.006) for slow in (0.01, 0.04)]
    starts = [np.log([1.0 / fast + 1.0 / slow, 1.0 / (fast * slow)]) for fast, slow in times]
    theta = _searched_from(starts, stretches, period_s, _torques(stretches, period_s, friction, None))
    if friction and any(stretch.rest for stretch in stretches):
        held = _torques(stretches, period_s, friction, theta)
        theta = _searched_from([np.log(theta[:2])], stretches, period_s, held)
    return theta


def _searched_from(
    starts: Sequence[Floats], stretches: Sequence[Stretch], period_s: float, torques: Sequence[Floats | None]
) -> Floats:
    current = np.concatenate([stretch.current_a[stretch.valid] for stretch in stretches])

    def exogenous(logs: Floats) -> Floats:
        model = np.exp(logs)
        pairs = zip(stretches, torques, strict=True)
        rows = [_columns(stretch, period_s, torque, model).voltage for stretch, torque in pairs]
        wide = [_widened(row, place, len(rows)) for place, row in enumerate(rows)]
        return np.vstack([each[stretch.valid] for each, stretch in zip(wide, stretches, strict=True)])

    def misfit(logs: Floats) -> Floats:
        columns = exogenous(logs)
        return np.asarray(current - columns @ np.linalg.lstsq(columns, current, rcond=None)[0], np.float64)

    bounds = [0.0, 0.0], np.log(HIGHEST)
    tries = (least_squares(misfit, start, diff_step=1e-4, bounds=bounds, max_nfev=MOST_STEPS) for start in starts)
    found = min(tries, key=lambda each: float(each.cost))
    if not found.success or np.any(found.x > np.log(HIGHEST) - 0.01):
        raise Failure(
            "the transfer function cannot be told from these data: they excite the motor too little; record more steps "
            "of the voltage, switching on among them"
        )
    columns = exogenous(found.x)
    return np.concatenate([np.exp(found.x), np.linalg.lstsq(columns, current, rcond=None)[0]])


def simulated(function: TransferFunction, voltage_v: Floats, period_s: float) -> Floats:
    """Return the current [A] from rest for a voltage that is held between samples."""
    return held_answer(np.array([function.b1, function.b0]), np.array([function.a1, function.a0]), voltage_v, period_s)


def _round(
    stretches: Sequence[Stretch], period_s: float, friction: bool, model: Floats, theta: Floats | None
) -> Floats:
    """One regression with the filter 1/A of `model`; the first one, without a model's current, is least squares."""
    left, right = [], []
    torques = _torques(stretches, period_s, friction, theta)
    rows = [_columns(stretch, period_s, torque, model) for stretch, torque in zip(stretches, torques, strict=True)]
    for place, (stretch, columns) in enumerate(zip(stretches, rows, strict=True)):
        exogenous = _widened(columns.voltage, place, len(stretches))
        regressors = np.hstack([-columns.current, exogenous])
        instruments = regressors
        if theta is not None:
            modelled = exogenous @ theta[2:]
            instruments = np.hstack([-filtered(modelled, model, period_s, held=False), exogenous])
        target = stretch.current_a - columns.current @ model
        left.append(instruments[stretch.valid].T @ regressors[stretch.valid])
        right.append(instruments[stretch.valid].T @ target[stretch.valid])
    return _solved(np.sum(left, axis=0), np.sum(right, axis=0))


def _solved(left: Floats, right: Floats) -> Floats:
    scale = np.sqrt(np.abs(np.diag(left)))
    if not np.all(np.isfinite(left)) or np.any(scale == 0.0):
        raise Failure("the transfer function cannot be told from these data: voltage or current does not change")
    scaled = left / np.outer(scale, scale)
    if np.linalg.cond(scaled) > 1e14:
        raise Failure("the transfer function cannot be told from these data: record steps of the voltage")
    solution: Floats = np.linalg.solve(scaled, right / scale) / scale
    return solution


def _torques(
    stretches: Sequence[Stretch], period_s: float, friction: bool, theta: Floats | None
) -> list[Floats | None]:
    """Return the dry torque in each stretch in parts of T; None each where it is not asked for."""
    return [torque_part(each.voltage_v, each.rest, period_s, theta) if friction else None for each in stretches]


def _columns(stretch: Stretch, period_s: float, torque: Floats | None, model: Floats) -> _Columns:
    count = len(stretch.current_a)
    blocks = [filtered(stretch.voltage_v, model, period_s, held=True)]
    if torque is not None:
        blocks.append(held_answer([0.0, 1.0], model, torque, period_s)[:, np.newaxis])
    blocks.append(free_answers(count, model, period_s))
    return _Columns(np.hstack(blocks), filtered(stretch.current_a, model, period_s, held=False))


def _widened(columns: Floats, place: int, stretches: int) -> Floats:
    """Give each stretch its own two columns for the state at its start."""
    common = columns.shape[1] - 2
    wide = np.zeros((len(columns), common + 2 * stretches))
    wide[:, :common] = columns[:, :common]
    wide[:, common + 2 * place : common + 2 * place + 2] = columns[:, common:]
    return wide


def _result(stretches: Sequence[Stretch], period_s: float, friction: bool, theta: Floats, count: int) -> TransferFit:
    """Collect the coefficients and their covariance."""
    fitted: list[FittedStretch] = []
    torques = _torques(stretches, period_s, friction, theta)
    for place, (stretch, torque) in enumerate(zip(stretches, torques, strict=True)):
        exogenous = _widened(_columns(stretch, period_s, torque, theta[:2]).voltage, place, len(stretches))
        modelled = exogenous @ theta[2:]
        gradient = np.hstack([-filtered(modelled, theta[:2], period_s, held=False), exogenous])
        fitted.append(FittedStretch(gradient, stretch.current_a - modelled, stretch.voltage_v, stretch.valid))
    order = [2, 3, 0, 1, *([4] if friction else [])]
    model = VoltageAnswer(theta[2:4], theta[:2], period_s)
    covariance = covariance_of(fitted, model)[np.ix_(order, order)]
    function = TransferFunction(*(float(theta[index]) for index in order[:4]))
    residual_a = float(np.sqrt(np.mean(np.concatenate([each.errors() for each in fitted]) ** 2)))
    return TransferFit(function, float(theta[4]) if friction else 0.0, covariance, residual_a, count)
