"""What Tables 7-2, 7-5 and 7-6 of Dooner (2016) say, and how near ours come: factors, and the order of controllers."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from scipy.stats import kendalltau

from hilplant.control.catalogue import FUZZY_GAINS, THESIS_PID, neuron, pid
from hilplant.control.records import Controller
from hilplant.models.records import Motor
from hilplant.thesis.control_test import Metrics


class ThesisRow(NamedTuple):
    """One row of the thesis: where it stands, who it is, and its twelve numbers in the thesis' order."""

    table: str
    rule: str
    gain: float
    fuzzy: bool
    numbers: tuple[float, ...]

    @property
    def name(self) -> str:
        """The name that the row has in ours."""
        if self.rule == "pid":
            return "pid"
        return f"{self.rule} fuzzy {self.gain:g}" if self.fuzzy else f"{self.rule} K={self.gain:g}"


_NUMBERS = """
7-2 pid         0    0     0.765 0.35  0.2   0.818 0.416  1.179 0.453 0.410 0.263 0.311 0.186
7-5 hebb        0.08 0     0.127 0.189 0.151 0.435 0.277  0.626 0.421 0.223 0.184 0.153 0.118
7-5 hebb        0.1  0.137 0.082 0.156 0.127 0.355 0.2315 0.507 0.342 0.183 0.158 0.124 0.097
7-5 hebb        0.5  1.826 0.028 0.031 0.026 0.067 0.049  0.281 0.309 0.037 0.045 0.025 0.020
7-5 error_hebb  0.2  0     0.126 0.184 0.148 0.427 0.272  0.615 0.411 0.220 0.180 0.153 0.117
7-5 error_hebb  0.6  0.739 0.036 0.063 0.054 0.141 0.099  0.268 0.327 0.076 0.069 0.052 0.042
7-5 error_hebb  1    1.387 0.025 0.038 0.032 0.082 0.060  0.264 0.301 0.045 0.041 0.031 0.025
7-5 quadratic   0.05 0     0.716 0.282 0.195 0.656 0.375  0.947 0.584 0.330 0.229 0.242 0.164
7-5 quadratic   0.1  0.052 0.098 0.171 0.138 0.394 0.255  0.569 0.384 0.204 0.172 0.140 0.109
7-5 quadratic   0.5  0.055 0.118 0.155 0.126 0.361 0.232  0.495 0.326 0.176 0.150 0.099 0.079
7-6 hebb        0.5  0.559 0.092 0.043 0.037 0.097 0.069  0.133 0.096 0.052 0.047 0.035 0.028
7-6 error_hebb  1.5  0.529 0.08  0.035 0.030 0.079 0.057  0.109 0.078 0.042 0.039 0.029 0.023
7-6 quadratic   0.5  0.553 0.094 0.044 0.037 0.099 0.070  0.135 0.097 0.052 0.048 0.038 0.030
"""


def _row(line: str) -> ThesisRow:
    table, rule, gain, *numbers = line.split()
    return ThesisRow(table, rule, float(gain), table == "7-6", tuple(map(float, numbers)))


ROWS = tuple(_row(line) for line in _NUMBERS.strip().splitlines())
assert all(row.gain == FUZZY_GAINS[row.rule] for row in ROWS if row.fuzzy)

COLUMNS = ("overshoot", "rise", *(f"state {n} {side}" for n in range(1, 6) for side in ("low", "high")))
RISE = COLUMNS.index("rise")
FIRST_ERROR = COLUMNS.index("state 1 low")
STATE_3 = (COLUMNS.index("state 3 low"), COLUMNS.index("state 3 high"))


def controller_of(row: ThesisRow, motor: Motor, period_s: float) -> Controller:
    """Return the controller of a row."""
    if row.rule == "pid":
        return pid(motor, period_s, THESIS_PID)
    return neuron(motor, period_s, row.rule, row.gain, row.fuzzy)


def factors(row: ThesisRow, ours: Metrics) -> dict[str, float]:
    """Return ours over the thesis' for each column; a column that is 0 in the thesis is left out."""
    pairs = zip(COLUMNS, ours.row(), row.numbers, strict=True)
    return {column: mine / its for column, mine, its in pairs if its > 0.0}


def far_off(row: ThesisRow, ours: Metrics, limit: float = 3.0) -> dict[str, float]:
    """Return the columns in which ours is not within a factor of `limit` of the thesis'."""
    return {name: f for name, f in factors(row, ours).items() if not 1.0 / limit <= f <= limit}


class Order(NamedTuple):
    """How alike two orders are: Kendall's tau, and the pairs in the other order, the widest apart in the thesis first.

    A pair is (the one that is first in the thesis, the other, the thesis' ratio of their figures).
    """

    tau: float
    swapped: tuple[tuple[str, str, float], ...]


def compare_order(names: Sequence[str], its: Sequence[float], ours: Sequence[float]) -> Order:
    """Compare the order of controllers by one figure."""
    tau = float(kendalltau(its, ours).statistic)
    swapped = [
        (names[a], names[b], its[b] / its[a])
        for a in range(len(names))
        for b in range(len(names))
        if its[a] < its[b] and ours[a] > ours[b]
    ]
    return Order(tau, tuple(sorted(swapped, key=lambda pair: -pair[2])))


def orders(results: Mapping[str, Metrics]) -> dict[str, Order]:
    """Compare the order by rise time and by disturbance rejection, which is the mean of the errors.

    Two rows of the thesis (Hebb K=0.5, Error-Hebb K=1) have in state 3 what can only be the overshoot of the step to
    it: four times their state 2. So the order is also given without state 3.
    """
    names, its = [row.name for row in ROWS], [row.numbers for row in ROWS]
    ours = [results[name].row() for name in names]
    return {
        "rise time": compare_order(names, [row[RISE] for row in its], [row[RISE] for row in ours]),
        "disturbance rejection": compare_order(names, [_mean(row) for row in its], [_mean(row) for row in ours]),
        "disturbance rejection without state 3": compare_order(
            names, [_mean(row, STATE_3) for row in its], [_mean(row, STATE_3) for row in ours]
        ),
    }


def _mean(numbers: Sequence[float], without: tuple[int, ...] = ()) -> float:
    errors = [value for place, value in enumerate(numbers) if place >= FIRST_ERROR and place not in without]
    return math.fsum(errors) / len(errors)
