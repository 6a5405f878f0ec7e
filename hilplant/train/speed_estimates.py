"""How well the speed is known without a sensor, over the full range, and when a parameter is 20 % off.

The estimators keep the nominal parameters; the plant's change. That is the case of a motor that warms up, ages, or
comes from another batch.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench
from hilplant.control.catalogue import ADAPTING, BLIND_NOISE
from hilplant.control.closed_loop import observe_rows
from hilplant.control.design import armature, model
from hilplant.jit import uninterrupted
from hilplant.models.records import Brush, Motor, Parameters
from hilplant.train.speed_network import NetworkRecord, record

OFF = 0.2
ESTIMATORS = ("network", "observer", "observer, resistance adapting")
SECONDS = 40.0
#: Errors count from here on [s], when the adapting observer has seen some turns.
FROM_S = 16.0


class Error(NamedTuple):
    """Error of an estimated crank speed [rad/s]: root mean square, largest, and the mean, which tells a bias."""

    rms_rad_s: float
    worst_rad_s: float
    mean_rad_s: float


class Case(NamedTuple):
    """Errors with one parameter off: which, by what factor, with which brush, by estimator."""

    parameter: str
    factor: float
    brush: str
    errors: dict[str, Error]


def _brushes(motor: Motor, change: Callable[[Brush], Brush]) -> Motor:
    return motor._replace(slow=change(motor.slow), fast=change(motor.fast))


#: How each parameter of the plant is changed by a factor.
CHANGES: dict[str, Callable[[Parameters, float], Parameters]] = {
    "resistance": lambda p, f: p._replace(
        motor=_brushes(p.motor, lambda b: b._replace(resistance_ohm=b.resistance_ohm * f))
    ),
    "inductance": lambda p, f: p._replace(
        motor=_brushes(p.motor, lambda b: b._replace(inductance_henry=b.inductance_henry * f))
    ),
    "constant": lambda p, f: p._replace(motor=_brushes(p.motor, lambda b: b._replace(constant_v_s=b.constant_v_s * f))),
    "inertia": lambda p, f: p._replace(motor=p.motor._replace(inertia_kg_m2=p.motor.inertia_kg_m2 * f)),
    "damping": lambda p, f: p._replace(motor=p.motor._replace(damping_n_m_s=p.motor.damping_n_m_s * f)),
    "blade force": lambda p, f: p._replace(
        load=p.load._replace(
            left_blade=p.load.left_blade._replace(force_n=p.load.left_blade.force_n * f),
            right_blade=p.load.right_blade._replace(force_n=p.load.right_blade.force_n * f),
        )
    ),
}


def full_range(step_s: float, seed: int = 2) -> tuple[Floats, Floats]:
    """Return voltages from 3 to 20 V, wandering by steps and ramps, and wetness, wet and dry by turns."""
    generator = np.random.default_rng(seed)
    ticks, corners = round(SECONDS / step_s), np.sort(generator.uniform(0.0, SECONDS, 20))
    levels = generator.uniform(3.0, 20.0, corners.size)
    time_s = np.arange(ticks) * step_s
    ramps = np.interp(time_s, corners, levels)
    steps = levels[np.clip(np.searchsorted(corners, time_s) - 1, 0, None)]
    voltages = np.where((time_s // 10.0) % 2 < 1, ramps, steps)
    return voltages, np.where((time_s // 7.0) % 2 < 1, 1.0, 0.0)


def estimator_table(bench: Bench, paths: tuple[Floats, Floats]) -> list[Case]:
    """Return the errors of all estimators: nominal, then each parameter of the plant 20 % down and up."""
    variants = [("nominal", 1.0)] + [(name, factor) for name in CHANGES for factor in (1.0 - OFF, 1.0 + OFF)]
    voltages, wetness = full_range(bench.parameters.step_s)
    cases = []
    for name, factor in variants:
        parameters = CHANGES[name](bench.parameters, factor) if name in CHANGES else bench.parameters
        for fast, brush in ((False, "slow"), (True, "fast")):
            data = record(bench, parameters, voltages, wetness, fast)
            speeds = estimated(bench, data, fast, paths[int(fast)])
            cases.append(Case(name, factor, brush, {e: error(s, data, bench) for e, s in speeds.items()}))
    return cases


def estimated(bench: Bench, data: NetworkRecord, fast: bool, path: Floats) -> dict[str, Floats]:
    """Return the crank speeds [rad/s] that each estimator makes of a recording."""
    period_s = bench.parameters.step_s
    believed = model(armature(bench.parameters.motor, fast), period_s, BLIND_NOISE, False)
    rows = np.ascontiguousarray(np.stack([data.voltage_v, data.current_a, data.park_contact], axis=1))
    speeds = {ESTIMATORS[0]: network_speeds(data, path)}
    for name, adapting in zip(ESTIMATORS[1:], (0.0, ADAPTING), strict=True):
        speeds[name] = np.empty(len(rows))
        with uninterrupted():
            observe_rows(believed, period_s, adapting, rows, speeds[name])
    return speeds


def network_speeds(data: NetworkRecord, path: Floats) -> Floats:
    """Return the network's speeds [rad/s] for a whole recording; the loop's own is ``control.network``."""
    before = np.concatenate([[0.0], data.voltage_v[:-1]])
    x, y = ((v - middle) / half for v, (middle, half) in zip((before, data.current_a), path[:2, :2], strict=True))
    hidden = np.tanh(np.outer(x, path[3:, 0]) + np.outer(y, path[3:, 1]) + path[3:, 2])
    return np.asarray(path[2, 0] + path[2, 1] * (hidden @ path[3:, 3] + path[0, 3]))


def error(speeds: Floats, data: NetworkRecord, bench: Bench) -> Error:
    """Return the error of estimated speeds once the adapting observer has settled."""
    difference = (speeds - data.speed_rad_s)[round(FROM_S / bench.parameters.step_s) :]
    return Error(float(np.sqrt(np.mean(difference**2))), float(np.abs(difference).max()), float(np.mean(difference)))
