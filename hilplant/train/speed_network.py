"""Training of the speed network of section 7.5 of Dooner (2016): one hidden layer of tanh neurons for each brush.

The thesis trains over the full range of voltages, wet and dry; its training data are lost figures. Here the plant makes
them: stairs of voltage, wet and dry; and Levenberg-Marquardt fits them. "Hidden layers" of its listings are neurons:
ten, and eight in the other path.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench, initial_state
from hilplant.models.plant import simulate_rows
from hilplant.models.records import Parameters
from hilplant.models.row import pack
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, OUTPUTS

NEURONS = {"slow": 10, "fast": 8}
#: Voltages of the stairs [V], and how long each is held [s].
STAIRS_V, HOLD_S = (2.0, 5.0, 8.0, 11.0, 14.0, 17.0, 20.0, 12.0, 6.0, 15.0, 9.0, 18.0, 3.0), 1.0
#: One tick in so many is used for training.
SPARSE = 20


class NetworkRecord(NamedTuple):
    """A recording of the motor: voltage [V], current [A], park contact, speed of the crank [rad/s]; one a tick."""

    voltage_v: Floats
    current_a: Floats
    park_contact: Floats
    speed_rad_s: Floats


def record(bench: Bench, parameters: Parameters, voltages_v: Floats, wetness: Floats, fast: bool) -> NetworkRecord:
    """Run the plant open-loop with given voltages and wetness, one a tick."""
    rows = np.tile(bench.input_row, (voltages_v.size, 1))
    for name, values in (("relay_on", 1.0), ("relay_fast", float(fast)), ("supply_v", voltages_v), ("screen", wetness)):
        rows[:, INPUT_INDEX[name]] = values
    outputs = np.empty((len(rows), len(OUTPUTS)))
    simulate_rows(initial_state(parameters, bench.initial), rows, pack(parameters), bench.tables, outputs)
    names = ("current_a", "park_contact", "crank_speed_rad_s")
    return NetworkRecord(voltages_v, *(outputs[:, OUTPUT_INDEX[name]].copy() for name in names))


def training_record(bench: Bench, fast: bool) -> NetworkRecord:
    """Return stairs of voltage, first on a wet screen, then on a dry one."""
    stairs = np.repeat(np.array(STAIRS_V), round(HOLD_S / bench.parameters.step_s))
    wetness = np.repeat([1.0, 0.0], stairs.size)
    return record(bench, bench.parameters, np.tile(stairs, 2), wetness, fast)


def train(data: NetworkRecord, neurons: int, seed: int = 1) -> Floats:
    """Fit a path by Levenberg-Marquardt from seeded weights; return it as ``control.network`` reads it.

    Voltage and current belong together as the controller sees them: the voltage is the one that was in force up to
    the tick at which current and speed were taken. The last digits of the weights depend on where in memory the solver
    works; the speeds agree to some 1e-9 rad/s from run to run.
    """
    before = np.concatenate([[0.0], data.voltage_v[:-1]])
    columns = [values[::SPARSE] for values in (before, data.current_a, data.speed_rad_s)]
    scales = [(0.5 * (v.max() + v.min()), 0.5 * (v.max() - v.min())) for v in columns]
    x, y, target = ((values - middle) / half for values, (middle, half) in zip(columns, scales, strict=True))
    start = np.random.default_rng(seed).normal(0.0, 0.5, 4 * neurons + 1)

    def difference(weights: Floats) -> Floats:
        hidden = weights[:-1].reshape(4, neurons)
        active = np.tanh(np.outer(x, hidden[0]) + np.outer(y, hidden[1]) + hidden[2])
        return np.asarray(active @ hidden[3] + weights[-1] - target)

    def jacobian(weights: Floats) -> Floats:
        hidden = weights[:-1].reshape(4, neurons)
        active = np.tanh(np.outer(x, hidden[0]) + np.outer(y, hidden[1]) + hidden[2])
        slope = (1.0 - active**2) * hidden[3]
        return np.hstack([slope * x[:, np.newaxis], slope * y[:, np.newaxis], slope, active, np.ones((x.size, 1))])

    answer = least_squares(difference, start, jacobian, method="lm", max_nfev=100)
    path = np.zeros((neurons + 3, 4))
    path[:3, :2] = scales
    path[0, 3] = answer.x[-1]
    path[3:] = answer.x[:-1].reshape(4, neurons).T
    return path


def trained_paths(bench: Bench, seed: int = 1) -> tuple[Floats, Floats]:
    """Return the paths of the slow and of the fast brush."""
    slow, fast = (train(training_record(bench, brush == "fast"), NEURONS[brush], seed) for brush in ("slow", "fast"))
    return slow, fast
