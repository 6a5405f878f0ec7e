"""A search for better gains of each learning rule, without overshoot and with little, by differential evolution."""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import differential_evolution

from hilplant.bench.assembly import Bench
from hilplant.control.catalogue import CALM_GAINS, FUZZY_GAINS, INITIAL_WEIGHTS, searched_neuron
from hilplant.control.records import RULES
from hilplant.thesis.control_test import Metrics, metrics, run_drive, thesis_drive
from hilplant.units import SECOND_NS

#: Highest overshoot [rad/s] of each aim: none to speak of, with a fixed K; and the thesis' limit for the fuzzy K.
AIMS = {"calm": 0.01, "quick": 0.6}

#: Bounds of the decimal logarithms: K or the fuzzy gain; learning rates (integral, proportional, derivative); weights.
BOUNDS = ((-1.5, 0.8), (-2.0, 2.0), (-2.0, 2.0), (-2.0, 2.0), (-1.0, 3.0), (-1.0, 3.0), (-1.0, 3.0))

#: Cost of each rad/s of overshoot beyond the aim.
PENALTY = 50.0


class FoundGains(NamedTuple):
    """What a search found: gains as :func:`~hilplant.control.catalogue.searched_neuron` takes them, and the cost."""

    rule: str
    aim: str
    gains: tuple[float, ...]
    cost: float
    metrics: Metrics
    runs: int


def cost(result: Metrics, highest_overshoot_rad_s: float) -> float:
    """Return rise time [s] plus worst error [rad/s], one counting as much as the other, plus the penalty."""
    if not math.isfinite(result.rise_s):
        return 100.0
    beyond = max(0.0, result.overshoot_rad_s - highest_overshoot_rad_s)
    return result.rise_s + result.worst_rad_s + PENALTY * beyond


def search(bench: Bench, rule: str, aim: str, seed: int = 1, generations: int = 25) -> FoundGains:
    """Search the gains of one rule for one aim, from the thesis' gains on; the same seed finds the same gains."""
    motor, period_s, drive = bench.parameters.motor, bench.step_ns / SECOND_NS, thesis_drive(bench)
    runs = 0

    def result(logarithms: np.ndarray) -> Metrics:
        nonlocal runs
        runs += 1
        gains = tuple(float(value) for value in 10.0**logarithms)
        return metrics(run_drive(bench, searched_neuron(motor, period_s, (rule, aim), gains), drive))

    answer = differential_evolution(
        lambda logarithms: cost(result(logarithms), AIMS[aim]),
        BOUNDS,
        x0=np.clip(source_gains(rule, aim), *np.transpose(BOUNDS)),
        rng=np.random.default_rng(seed),
        popsize=8,
        maxiter=generations,
        tol=0.0,
        polish=False,
    )
    gains = tuple(float(f"{value:.4g}") for value in 10.0**answer.x)
    return FoundGains(rule, aim, gains, float(answer.fun), result(np.log10(gains)), runs)


def source_gains(rule: str, aim: str) -> np.ndarray:
    """Return the decimal logarithms of the thesis' gains; a weight of 0 is taken as 0.1."""
    gain = CALM_GAINS[rule] if aim == "calm" else FUZZY_GAINS[rule]
    weights = [max(weight, 0.1) for weight in INITIAL_WEIGHTS[rule]]
    return np.log10([gain, 1.0, 1.5, 1.0, *weights])


def search_all(bench: Bench, seed: int = 1, generations: int = 25) -> list[FoundGains]:
    """Search each rule for each aim."""
    return [search(bench, rule, aim, seed, generations) for rule in RULES for aim in AIMS]
