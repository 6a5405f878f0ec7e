"""The motor as a network with feedback (NARX), section 6.4.3 and Appendix F of Dooner (2016), in compiled code.

Voltage and torque of this tick and the one before, current and speed now and a tick ago go in, current and speed a
tick later come out, (6.9) with two delays. There is a path for each brush: one layer of tanh neurons, linear outputs.
Speeds and torques are those of the gear's output shaft, the crank, as in the thesis.

All numbers stand in one row: how many belong to the torque network, these, then the path of the slow brush and that
of the fast one. A path is: neurons, the limits of its training (four low ones, four high ones: voltage, torque,
current, speed), two output biases, then for each neuron its bias, its eight input weights, and its weights in current
and speed. Scaling is contained in the weights: they take and give SI units. tanh c is written as 1 - 2/(1 + exp(2c));
its factors 2 and the sum of its ones are contained in the numbers as well.
"""

import math
from typing import Any, NamedTuple

from hilplant.jit import compiled
from hilplant.models.records import Sample

#: Numbers before the first neuron of a path, and numbers of a neuron.
HEAD = 11
NEURON = 11

#: Brushes, as `MotorMemory.brush`; NO_BRUSH: there is nothing that the network could go on from.
NO_BRUSH, SLOW_BRUSH, FAST_BRUSH = 0.0, 1.0, 2.0

#: Who moves the motor, as ``signals.ACTIVE_MODELS``: the physical model of a bench without network; the network; the
#: physical model because the motor stands, is cut off or has just been switched; the same because the network's
#: training does not reach there.
PHYSICAL, NETWORK, STANDSTILL, OUTSIDE = 0.0, 1.0, 2.0, 3.0

#: Once the physical model is active, this part of each training range is left at both ends before the network is
#: trusted again: the hysteresis of the guard.
RETURN_MARGIN = 0.02

#: Torques [N m] that a tick of rounding leaves behind are no reason to distrust a network whose range begins at 0.
TORQUE_ROUNDING_N_M = 1e-6


class Prediction(NamedTuple):
    """Current and speed a tick later, and their derivatives by the torque during it."""

    current_a: float
    speed_rad_s: float
    current_by_torque: float
    speed_by_torque: float


@compiled
def path_of(networks: Any, brush: float) -> int:
    """Return where in the row the path of a brush begins."""
    slow = 1 + int(networks[0])
    return slow if brush == SLOW_BRUSH else slow + HEAD + NEURON * int(networks[slow])


@compiled
def predict(networks: Any, path: int, now: Sample, before: Sample) -> Prediction:
    """Return what the network expects a tick after `now`."""
    current, speed = networks[path + 9], networks[path + 10]
    current_by_torque, speed_by_torque = 0.0, 0.0
    at = path + HEAD
    for _ in range(int(networks[path])):
        one = networks[at] + networks[at + 1] * now.terminal_v + networks[at + 2] * now.torque_n_m
        two = networks[at + 3] * now.current_a + networks[at + 4] * now.speed_rad_s
        three = networks[at + 5] * before.terminal_v + networks[at + 6] * before.torque_n_m
        four = networks[at + 7] * before.current_a + networks[at + 8] * before.speed_rad_s
        output = 1.0 / (1.0 + math.exp((one + two) + (three + four)))
        slope = output * (output - 1.0) * networks[at + 2]
        current += networks[at + 9] * output
        speed += networks[at + 10] * output
        current_by_torque += networks[at + 9] * slope
        speed_by_torque += networks[at + 10] * slope
        at += NEURON
    return Prediction(current, speed, current_by_torque, speed_by_torque)


@compiled
def within(networks: Any, path: int, sample: Sample, margin: float) -> bool:
    """Return whether a sample lies in the training range, less the part `margin` of it at both ends.

    The lower ends of voltage and torque have no margin where they are 0, which is where a motor switched off and a
    load that the worm holds are.
    """
    return (
        inside(networks, path + 1, sample.terminal_v, margin)
        and inside(networks, path + 2, sample.torque_n_m, margin)
        and inside(networks, path + 3, sample.current_a, margin)
        and inside(networks, path + 4, sample.speed_rad_s, margin)
    )


@compiled
def inside(networks: Any, low_at: int, number: float, margin: float) -> bool:
    """Return whether a number lies between its limits; not-a-number does not."""
    low, high = networks[low_at], networks[low_at + 4]
    kept = margin * (high - low)
    lowest = low - TORQUE_ROUNDING_N_M if low == 0.0 else low + kept
    return bool(lowest <= number <= high - kept)
