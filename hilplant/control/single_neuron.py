"""Single-neuron PID with three learning rules, section 7.3 of Dooner (2016), and its gain K from a fuzzy table, 7.4.

The third input is e(k) - 2 e(k-1) + e(k-2). (7.2)-(7.4) print the last sign the other way; with it the input would
not be a second difference, and the Error-Hebb rule would never move the motor.
"""

from typing import Any

from hilplant.control.records import RULES, Controller, Neuron, NeuronMemory
from hilplant.jit import compiled

HEBB, ERROR_HEBB, QUADRATIC = (float(index) for index in range(len(RULES)))

#: K belongs to increments at this period [s]; at another one sum and differences are taken in proportion.
BASE_PERIOD_S = 0.001
#: Weights whose absolute sum is below this have lost their meaning; the neuron then begins anew.
SMALLEST_SUM = 1e-12
#: Weights grow without limit under (7.8); beyond this all are scaled back, which (7.7) does not see.
LARGEST_WEIGHT = 1e6


@compiled
def single_neuron(
    memory: NeuronMemory, voltage_v: float, error_rad_s: float, controller: Controller, gain_table: Any
) -> tuple[NeuronMemory, float]:
    """Return the memory with the weights after learning, and the voltage [V] that follows `voltage_v`, (7.5)-(7.7).

    The error is the reference less the speed of the crank. The voltage is a sum of increments and is held within its
    limits, so nothing winds up behind them.
    """
    neuron = controller.neuron
    error = error_rad_s
    x1, x2, x3 = error, error - memory.error, error - 2.0 * memory.error + memory.error_before
    w1, w2, w3 = memory.integral, memory.proportional, memory.derivative
    total = abs(w1) + abs(w2) + abs(w3)
    if total < SMALLEST_SUM:
        w1, w2, w3 = neuron.start_integral, neuron.start_proportional, neuron.start_derivative
        total = abs(w1) + abs(w2) + abs(w3)
    gain = neuron.gain * (fuzzy_gain(error, gain_table) if neuron.fuzzy > 0.5 else 1.0)
    pace = controller.period_s / BASE_PERIOD_S
    increment = gain * (w1 * x1 * pace + w2 * x2 + w3 * x3 / pace) / total
    voltage = min(max(voltage_v + increment, controller.lowest_v), controller.highest_v)
    s1, s2, s3 = signals(neuron, gain, voltage, (x1, x2, x3), (w1, w2, w3))
    w1 += neuron.rate_integral * s1
    w2 += neuron.rate_proportional * s2
    w3 += neuron.rate_derivative * s3
    w1, w2, w3 = kept_finite(w1, w2, w3)
    return NeuronMemory(error, memory.error, w1, w2, w3, gain), voltage


@compiled
def signals(
    neuron: Neuron,
    gain: float,
    voltage: float,
    inputs: tuple[float, float, float],
    weights: tuple[float, float, float],
) -> tuple[float, float, float]:
    """Return what each weight learns before its learning rate: (7.8), (7.9) or (7.10)."""
    x1, x2, x3 = inputs
    if neuron.rule == HEBB:
        both = x1 * voltage
        return both * x1, both * x2, both * x3
    if neuron.rule == ERROR_HEBB:
        same = x1 * voltage * (x1 + x2)
        return same, same, same
    output = weights[0] * x1 + weights[1] * x2 + weights[2] * x3
    drive = gain * (neuron.error_weight * neuron.first_output * x1 - neuron.output_weight * gain * output)
    return drive * x1, drive * x2, drive * x3


@compiled
def kept_finite(w1: float, w2: float, w3: float) -> tuple[float, float, float]:
    """Return weights with the same proportions that cannot overflow; not-a-number becomes no weight at all."""
    largest = max(abs(w1), abs(w2), abs(w3))
    if not largest < 1e300:
        return 0.0, 0.0, 0.0
    if largest <= LARGEST_WEIGHT:
        return w1, w2, w3
    scale = LARGEST_WEIGHT / largest
    return w1 * scale, w2 * scale, w3 * scale


@compiled
def fuzzy_gain(error_rad_s: float, gain_table: Any) -> float:
    """Return K in [0, 1] for an error, from a table [n, 2] of error [rad/s] at even steps and K.

    Straight lines between the knots; beyond the table the value at its end, as the thesis treats errors beyond 3 rad/s.
    """
    last = gain_table.shape[0] - 1
    lowest, highest = gain_table[0, 0], gain_table[last, 0]
    place = (min(max(error_rad_s, lowest), highest) - lowest) * (last / (highest - lowest))
    index = min(int(place), last - 1)
    part = place - index
    low, high = gain_table[index, 1], gain_table[index + 1, 1]
    return float(low + part * (high - low))
