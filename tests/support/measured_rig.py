"""Data of a small rig of its own: plain equations, no model of the project."""

import math
from functools import cache

import numpy as np

from hilplant.measurements.columns import Column
from hilplant.measurements.measurement import Channel, Measurement
from hilplant.measurements.preparation import Preparation, prepare

R, L, K, J, B, N = 1.17, 2.9e-3, 0.044, 2.4e-5, 1.0e-4, 63.0
#: Seconds, volts: off, then the sequence of 5.2, then off.
STAGES = ((0.5, 0.0), (2.2, 10.0), (2.0, 12.0), (1.8, 14.0), (2.0, 16.0), (2.0, 12.0), (1.2, 0.0))


@cache
def rig(sample_hz: float = 1000.0, stages: tuple[tuple[float, float], ...] = STAGES) -> dict[str, np.ndarray]:
    """Integrate motor, dry and ripple load and park contact at 20 kHz; give every sample at `sample_hz`."""
    inner, volts = 5e-5, []
    for seconds, level in stages:
        volts += [level] * round(seconds / 5e-5)
    current = speed = turned = 0.0
    rows = np.empty((len(volts), 4))
    for tick, voltage in enumerate(volts):
        rows[tick] = tick * inner, voltage, current, 1.0 if math.cos(turned) > 0.9925 else 0.0
        load = (0.03 + 0.02 * math.sin(turned) ** 2) if speed > 0.0 or K * current > 0.05 else K * current
        current += inner * (voltage - R * current - K * speed) / L
        speed = max(0.0, speed + inner * (K * current - B * speed - load) / J)
        turned += inner * speed / N
    stride = round(1.0 / (sample_hz * inner))
    names = ("time", "U1", "I1", "PS")
    return {name: rows[::stride, index].copy() for index, name in enumerate(names)}


def channels(seed: int = 1, sample_hz: float = 1000.0, **changes: np.ndarray) -> dict[str, Channel]:
    """The rig's channels with noise, 10 mA quantisation and a ripple on the supply; `changes` replace columns."""
    clean = rig(sample_hz)
    random = np.random.default_rng(seed)
    count = len(clean["time"])
    noisy = {
        "U1": clean["U1"] + 0.02 * random.standard_normal(count),
        "I1": np.round((clean["I1"] + 0.1 * random.standard_normal(count)) / 0.01) * 0.01,
        "PS": clean["PS"],
    } | changes
    return {name: Channel(clean["time"], values) for name, values in noisy.items()}


COLUMNS = {"voltage": Column("U1"), "current": Column("I1"), "park": Column("PS")}


def prepared(how: Preparation | None = None, **changes: np.ndarray) -> Measurement:
    return prepare(channels(**changes), COLUMNS, how or Preparation(), "rig.csv")
