"""Signals behind 1/A and s/A of a model A = s^2 + a1 s + a0, in continuous time, from samples (`model`: a1, a0)."""

import warnings
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.signal import BadCoefficients, cont2discrete, lfilter

from hilplant.arrays import Floats


def filtered(values: Floats, model: Floats, period_s: float, held: bool) -> Floats:
    """Return s/A and 1/A of a signal that is held between samples, or else is a straight line between them."""
    first = 0.0 if held else values[0]
    answers = [held_answer(numerator, model, values, period_s, held) for numerator in ([1.0, 0.0], [0.0, 1.0])]
    return np.column_stack(answers) if first == 0.0 else _from_level(values, model, period_s)


def _from_level(values: Floats, model: Floats, period_s: float) -> Floats:
    """Filter a signal as if it had been at its first value for ever, so that no jump is seen at its start."""
    first = values[0]
    moved = [held_answer(numerator, model, values - first, period_s, False) for numerator in ([1.0, 0.0], [0.0, 1.0])]
    return np.column_stack([moved[0], moved[1] + first / model[1]])


def held_answer(
    numerator: Floats | list[float], model: Floats, values: Floats, period_s: float, held: bool = True
) -> Floats:
    """Return a signal behind numerator/A; it is held between samples, or else a straight line between them."""
    top, bottom = _discrete(tuple(numerator), tuple(model), period_s, held)
    return np.asarray(lfilter(top, bottom, values), np.float64)


@lru_cache(maxsize=64)
def _discrete(numerator: tuple[float, ...], model: tuple[float, ...], period_s: float, held: bool) -> tuple[Any, Any]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", BadCoefficients)  # a held input has a first coefficient of 0, as it must be
        top, bottom, _ = cont2discrete((numerator, (1.0, *model)), period_s, method="zoh" if held else "foh")
    return top.ravel(), bottom


def free_answers(count: int, model: Floats, period_s: float) -> Floats:
    """Return the answers of s/A and 1/A to an impulse at the start: what any state at the start decays with."""
    roots = np.roots([1.0, model[0], model[1]]).astype(complex)
    if abs(roots[0] - roots[1]) < 1e-6 * abs(roots[0]):
        roots[1] *= 1.0 + 1e-6
    times = np.arange(count) * period_s
    first, second = np.exp(roots[0] * times), np.exp(roots[1] * times)
    apart = roots[0] - roots[1]
    return np.column_stack([((roots[0] * first - roots[1] * second) / apart).real, ((first - second) / apart).real])


def stable(denominator: Floats) -> Floats:
    """Mirror roots of the filter into the stable half plane, away from its edge."""
    roots = np.roots([1.0, denominator[0], denominator[1]])
    mirrored = -np.maximum(np.abs(roots.real), 0.1) + 1j * roots.imag
    polynomial = np.poly(mirrored).real
    return np.array([polynomial[1], polynomial[2]])
