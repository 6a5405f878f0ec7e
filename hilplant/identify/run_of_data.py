"""A measurement prepared as a run: what drives the model, where it can begin, and the angles of the park edges."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.failure import Failure, Unfit
from hilplant.identify.experiment import Run, Start
from hilplant.measurements.measurement import Measurement, running
from hilplant.measurements.outliers import near_steps, spikes
from hilplant.measurements.park import rising_edges
from hilplant.signals import INPUT_INDEX
from hilplant.units import SECOND_NS, TURN_RAD

#: Rest that is kept before the motor is first on [s].
REST_S = 0.2
#: Terminal voltages below this are those of another circuit than a relay that grounds the brush [V].
MOST_NEGATIVE_V = -0.5


def make_run(data: Measurement, bench: Bench, screen: float) -> Run:
    """Prepare a measurement of one condition for a bench.

    Raises
    ------
    Unfit
        When voltage, park edges or start of the recording do not allow it.
    Failure
        When nothing says the mode, or it was sampled at another step than the bench's.

    """
    name = data.source or "data"
    if np.any(np.isnan(data.fast)):
        raise Failure(f"{name}: nothing says whether the motor runs slow or fast; write {name}@slow or {name}@fast")
    if abs(data.period_s - bench.step_ns / SECOND_NS) > 1e-9:
        raise Failure(f"{name}: has a sample every {data.period_s:g} s, and the bench steps {bench.step_ns / 1e9:g} s")
    lowest = float(np.min(data.voltage_v[data.valid]))
    if lowest < MOST_NEGATIVE_V:
        text = "the model is driven through a relay that grounds the brush; cut the file before the motor turns back"
        raise Unfit(f"{name}: the terminal voltage falls to {lowest:.3g} V; {text}")
    first, start = _start(data, bench)
    edges = rising_edges(data.park)
    edges = edges[edges > first]
    if len(edges) == 0:
        raise Unfit(f"{name}: no park edge after the start, so nothing tells the speed")
    closing = bench.parameters.park_switch.angle_rad - bench.parameters.park_switch.half_window_rad
    angles = np.asarray(closing + TURN_RAD * np.arange(1, len(edges) + 1), np.float64)
    return Run(
        name, _inputs(data, bench, screen)[first:], data.current_a[first:], data.voltage_v[first:], data.park[first:],
        data.valid[first:], data.period_s, start, edges - first, angles, _speeds(data, edges, first),
    )  # fmt: skip


def _inputs(data: Measurement, bench: Bench, screen: float) -> Floats:
    inputs = np.tile(bench.input_row, (len(data), 1))
    inputs[:, INPUT_INDEX["relay_on"]] = 1.0
    inputs[:, INPUT_INDEX["relay_fast"]] = data.fast
    inputs[:, INPUT_INDEX["supply_v"]] = np.maximum(_driving_v(data), 0.0)
    inputs[:, INPUT_INDEX["screen"]] = screen
    return inputs


def _driving_v(data: Measurement) -> Floats:
    """Return the voltage without the voltmeter's spikes, which the motor did not see."""
    spike = spikes(data.voltage_v, near_steps(data.voltage_v, data.period_s))
    places = np.arange(len(data))
    return np.where(spike, np.interp(places, places[~spike], data.voltage_v[~spike]), data.voltage_v)


def _start(data: Measurement, bench: Bench) -> tuple[int, Start]:
    """Return the first sample that is used, and what is known there."""
    on = running(data)
    first_on = int(np.argmax(on))
    rest = round(REST_S / data.period_s)
    switch = bench.parameters.park_switch
    if first_on >= rest // 2:
        first = max(0, first_on - rest)
        if data.park[first] > 0.5:
            reach = switch.half_window_rad + switch.hysteresis_rad
            return first, Start(True, 0.0, 1.0, switch.angle_rad, switch.angle_rad - reach, switch.angle_rad + reach)
        low, high = switch.angle_rad + switch.half_window_rad, switch.angle_rad - switch.half_window_rad + TURN_RAD
        return first, Start(True, 0.0, 0.0, 0.5 * (low + high), low, high)
    edges = rising_edges(data.park)
    if len(edges) < 2:
        raise Unfit(f"{data.source}: begins in motion and has fewer than two park edges; begin at rest")
    first = int(edges[0])
    speed = TURN_RAD / (float(edges[1] - edges[0]) * data.period_s)
    return first, Start(False, float(data.current_a[first]), 1.0, speed, 0.3 * speed, 2.0 * speed)


def _speeds(data: Measurement, edges: NDArray[np.intp], first: int) -> Floats:
    """Return the mean speed of the crank over the turn that ends at each edge, times at rest left out [rad/s]."""
    on = running(data)
    bounds = [first, *edges.tolist()]
    durations = [max(1, int(np.count_nonzero(on[begin:end]))) for begin, end in pairwise(bounds)]
    return np.asarray(TURN_RAD / (np.array(durations) * data.period_s), np.float64)
