"""The motor network run over a sequence, with all derivatives by its weights: compiled, for training alone.

In closed loop the network reads its own answers, so the derivatives of a tick contain those of the two ticks before:
forward sensitivities through the whole recurrent run. A stretch ends where the physical model is active, and the
next one begins from what that leaves, as in the plant. A horizon ends it earlier: 1 is the open loop, which reads the
true values in every tick; numbers between lead from there to the closed loop, in which a network that was trained in
open loop alone may run away.
"""

import math
from typing import Any

from hilplant.jit import compiled_for_threads

#: Inputs of a neuron: voltage, torque, current, speed, now and a tick ago.
WIDTH = 8


def weight_count(neurons: int) -> int:
    """Return how many weights a path has: in the order input weights, hidden biases, output weights, output biases."""
    return 11 * neurons + 2


def room_for(weights: int) -> int:
    """Return how many numbers a run needs room for."""
    return 16 + (weights - 2) // 11


@compiled_for_threads
def run(  # noqa: PLR0913, PLR0917
    weights: Any,
    inputs: Any,
    outputs: Any,
    earlier: Any,
    known: Any,
    horizon: int,
    predicted: Any,
    jacobian: Any,
    room: Any,
) -> None:
    """Fill `predicted` [n, 2], and `jacobian` [n, 2, weights] unless it has no rows; all scaled.

    `outputs` are what the network reads where it does not read its own answers, and `earlier` what it reads there as
    those of the tick before: the same, or near them.
    `jacobian[k]` belongs to `predicted[k]`; it is 0 where the network is not asked. `room` is for passing results,
    ``room_for(weights)`` numbers.
    """
    count, total = len(outputs), len(weights)
    with_derivatives = len(jacobian) == count
    x, feedback, hidden = room[:8], room[8:16], room[16:]
    predicted[0, 0], predicted[0, 1] = outputs[0, 0], outputs[0, 1]
    alone = 0  # ticks for which the network has read its own answers
    for k in range(count - 1):
        if with_derivatives:
            for o in range(2):
                for p in range(total):
                    jacobian[k + 1, o, p] = 0.0
        if not known[k]:
            predicted[k + 1, 0], predicted[k + 1, 1] = outputs[k + 1, 0], outputs[k + 1, 1]
            alone = 0
            continue
        now = predicted if alone > 0 else outputs
        before = predicted if alone > 1 else earlier
        x[0], x[1], x[4], x[5] = inputs[k, 0], inputs[k, 1], inputs[k - 1, 0], inputs[k - 1, 1]
        x[2], x[3], x[6], x[7] = now[k, 0], now[k, 1], before[k - 1, 0], before[k - 1, 1]
        fill_answer(weights, x, hidden, predicted[k + 1])
        if with_derivatives:
            row = jacobian[k + 1]
            own_derivatives(weights, x, hidden, row, feedback)
            if alone > 0:
                add_passed(row, jacobian[k], feedback, 0)
            if alone > 1:
                add_passed(row, jacobian[k - 1], feedback, 2)
        alone = alone + 1 if alone + 1 < horizon else 0


@compiled_for_threads
def fill_answer(weights: Any, x: Any, hidden: Any, answers: Any) -> None:
    """Fill the outputs of the hidden neurons and both answers [2] of the network to its inputs `x` [8]; all scaled."""
    neurons = len(hidden)
    for j in range(neurons):
        total_in = weights[8 * neurons + j]
        for m in range(8):
            total_in += weights[8 * j + m] * x[m]
        hidden[j] = math.tanh(total_in)
    for o in range(2):
        answer = weights[11 * neurons + o]
        for j in range(neurons):
            answer += weights[9 * neurons + o * neurons + j] * hidden[j]
        answers[o] = answer


@compiled_for_threads
def add_passed(row: Any, earlier: Any, feedback: Any, first: int) -> None:
    """Add to `row` what the derivatives of an earlier answer pass on through the feedback of current and speed."""
    for o in range(2):
        current, speed = feedback[4 * o + first], feedback[4 * o + first + 1]
        for p in range(row.shape[1]):
            row[o, p] += current * earlier[0, p] + speed * earlier[1, p]


@compiled_for_threads
def own_derivatives(weights: Any, x: Any, hidden: Any, row: Any, feedback: Any) -> None:
    """Fill the derivatives of one answer by the weights (`row` [2, weights]) and by what is fed back [2 x 4]."""
    neurons = len(hidden)
    for at in range(8):
        feedback[at] = 0.0
    for o in range(2):
        for j in range(neurons):
            slope = weights[9 * neurons + o * neurons + j] * (1.0 - hidden[j] * hidden[j])
            for m in range(8):
                row[o, 8 * j + m] = slope * x[m]
            row[o, 8 * neurons + j] = slope
            row[o, 9 * neurons + o * neurons + j] = hidden[j]
            feedback[4 * o] += slope * weights[8 * j + 2]
            feedback[4 * o + 1] += slope * weights[8 * j + 3]
            feedback[4 * o + 2] += slope * weights[8 * j + 6]
            feedback[4 * o + 3] += slope * weights[8 * j + 7]
        row[o, 11 * neurons + o] = 1.0
