"""Dry friction about a start from rest: it holds the shaft until the current has grown to what it takes.

A shaft at rest is held by as much torque as the current makes, not more, and none at no current. So the torque that
(5.7) is extended by grows with the current of a blocked motor, V/R (1 - exp(-t R/L)), up to T, and stays there.
"""

import numpy as np

from hilplant.arrays import Floats


def torque_part(voltage_v: Floats, rest: int, period_s: float, theta: Floats | None) -> Floats:
    """Return the mean dry torque from each sample to the next in parts of T; for `rest` samples the motor rests.

    `theta` are a1, a0, b1, b0, c as last estimated; None, or such as no motor has: all of T acts from the step on.
    """
    elapsed = (np.arange(len(voltage_v) + 1) - rest) * period_s
    at_once = np.where(elapsed[:-1] >= 0.0, 1.0, 0.0)
    if rest == 0 or theta is None:
        return at_once
    a1, a0, b1, b0, c = theta[:5].tolist()
    if not b1 > 0.0:
        return at_once
    electrical_1_s = a1 - b0 / b1
    resistance_ohm = electrical_1_s / b1
    stiffness = a0 - b0 * resistance_ohm  # K^2/(L J)
    if not (electrical_1_s > 0.0 and stiffness > 0.0 and c > 0.0):
        return at_once
    blocked = float(np.median(voltage_v[rest:])) / resistance_ohm / (c / stiffness)  # V/R in parts of T/K
    free_s = -np.log1p(-1.0 / blocked) / electrical_1_s if blocked > 1.0 else np.inf  # from then on it turns
    grown = np.clip(elapsed, 0.0, free_s)
    torque = blocked * (grown + np.expm1(-grown * electrical_1_s) / electrical_1_s)  # over time, from the step on
    return np.asarray(np.diff(torque + np.maximum(elapsed - grown, 0.0) * (elapsed > 0.0)) / period_s, np.float64)
