"""Speed from voltage and current by a small network, one path for each brush, section 7.5 of Dooner (2016)."""

import math
from typing import Any

from hilplant.jit import compiled


@compiled
def network_speed(voltage_v: float, current_a: float, path: Any) -> float:
    """Return the crank's speed [rad/s] from one path: a hidden layer of tanh neurons, and a linear output.

    Parameters
    ----------
    voltage_v, current_a
        Terminal voltage [V] and armature current [A].
    path
        Array [neurons + 3, 4]. Rows 0 to 2 scale voltage, current and speed: middle and half width of the data. Each
        other row is a neuron: weights of the scaled voltage and current, bias, and weight of its output. The
        output's bias is in the last column of row 0.

    """
    x = (voltage_v - path[0, 0]) / path[0, 1]
    y = (current_a - path[1, 0]) / path[1, 1]
    scaled = path[0, 3]
    for row in range(3, path.shape[0]):
        scaled += path[row, 3] * math.tanh(path[row, 0] * x + path[row, 1] * y + path[row, 2])
    return float(path[2, 0] + path[2, 1] * scaled)
