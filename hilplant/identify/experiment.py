"""A measurement as something that a bench can run again: inputs, start, and what is compared.

The measured terminal voltage drives the model: a relay that grounds the brush and a supply of 0 V are the same circuit.
A run begins at rest, or at the first park edge where the recording begins in motion. One number of its start is not
measured and is looked for with the parameters: the crank's angle at rest, else its speed at the edge. So is the offset
that is left in the current.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hilplant.batch import simulate_batch
from hilplant.bench import Bench
from hilplant.failure import Failure
from hilplant.identify.checks import running
from hilplant.identify.measurement import Mask, Measurement, Samples
from hilplant.identify.park import rising_edges
from hilplant.identify.places import PLACE, STATE_PLACE
from hilplant.signals import INPUT_INDEX
from hilplant.units import SECOND_NS, TURN_RAD

COLUMNS = ("current_a", "crank_angle_rad", "park_contact")
#: Rest that is kept before the motor is first on [s].
REST_S = 0.2
#: Terminal voltages below this are those of another circuit than a relay that grounds the brush [V].
MOST_NEGATIVE_V = -0.5

_STEP, _GEAR_RATIO = PLACE["step_s"], PLACE["motor.gear_ratio"]
_PARK_ANGLE, _HALF_WINDOW = PLACE["park_switch.angle_rad"], PLACE["park_switch.half_window_rad"]
_BOUNCE, _CIRCUIT = PLACE["park_switch.bounce_ticks"], PLACE["park_switch.circuit"]


class Start(NamedTuple):
    """Where a run begins; `low` and `high` bound what is not known of it: an angle [rad], or a crank speed [rad/s]."""

    at_rest: bool
    current_a: float
    contact: float
    guess: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Run:
    """One recording, from where the model can begin.

    `edges` are the samples of the park contact's closings, `edge_turns` the crank's angle there [rad], counted on from
    the start; `edge_speed_rad_s` is the mean speed of the crank up to each.
    """

    name: str
    inputs: NDArray[np.float64]
    current_a: Samples
    voltage_v: Samples
    park: Samples
    valid: Mask
    period_s: float
    start: Start
    edges: NDArray[np.intp]
    edge_angles_rad: Samples
    edge_speeds_rad_s: Samples

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.current_a)

    @property
    def time_s(self) -> Samples:
        """Time from the start of the run."""
        return np.asarray(np.arange(len(self)) * self.period_s, np.float64)

    @property
    def park_steps(self) -> Samples:
        """How often the contact has closed since the start (5.2)."""
        steps = np.zeros(len(self))
        steps[self.edges] = 1.0
        return np.cumsum(steps)


def make_run(data: Measurement, bench: Bench, screen: float) -> Run:
    """Prepare a measurement of one condition for a bench.

    Raises
    ------
    Failure
        When mode or start of the recording do not allow it, or it was sampled at another step than the bench's.

    """
    name = data.source or "data"
    if np.any(np.isnan(data.fast)):
        raise Failure(f"{name}: nothing says whether the motor runs slow or fast; write {name}@slow or {name}@fast")
    if abs(data.period_s - bench.step_ns / SECOND_NS) > 1e-9:
        raise Failure(f"{name}: has a sample every {data.period_s:g} s, and the bench steps {bench.step_ns / 1e9:g} s")
    lowest = float(np.min(data.voltage_v[data.valid]))
    if lowest < MOST_NEGATIVE_V:
        text = "the model is driven through a relay that grounds the brush; cut the file before the motor turns back"
        raise Failure(f"{name}: the terminal voltage falls to {lowest:.3g} V; {text}")
    first, start = _start(data, bench)
    edges = rising_edges(data.park)
    edges = edges[edges > first]
    if len(edges) == 0:
        raise Failure(f"{name}: no park edge after the start, so nothing tells the speed")
    closing = bench.parameters.park_switch.angle_rad - bench.parameters.park_switch.half_window_rad
    angles = np.asarray(closing + TURN_RAD * np.arange(1, len(edges) + 1), np.float64)
    return Run(
        name, _inputs(data, bench, screen)[first:], data.current_a[first:], data.voltage_v[first:], data.park[first:],
        data.valid[first:], data.period_s, start, edges - first, angles, _speeds(data, edges, first),
    )  # fmt: skip


def _inputs(data: Measurement, bench: Bench, screen: float) -> NDArray[np.float64]:
    inputs = np.tile(bench.input_row, (len(data), 1))
    inputs[:, INPUT_INDEX["relay_on"]] = 1.0
    inputs[:, INPUT_INDEX["relay_fast"]] = data.fast
    inputs[:, INPUT_INDEX["supply_v"]] = np.maximum(data.voltage_v, 0.0)
    inputs[:, INPUT_INDEX["screen"]] = screen
    return inputs


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
        raise Failure(f"{data.source}: begins in motion and has fewer than two park edges; begin at rest")
    first = int(edges[0])
    speed = TURN_RAD / (float(edges[1] - edges[0]) * data.period_s)
    return first, Start(False, float(data.current_a[first]), 1.0, speed, 0.3 * speed, 2.0 * speed)


def _speeds(data: Measurement, edges: NDArray[np.intp], first: int) -> Samples:
    """Return the mean speed of the crank over the turn that ends at each edge, times at rest left out [rad/s]."""
    on = running(data)
    bounds = [first, *edges.tolist()]
    durations = [max(1, int(np.count_nonzero(on[begin:end]))) for begin, end in pairwise(bounds)]
    return np.asarray(TURN_RAD / (np.array(durations) * data.period_s), np.float64)


class Simulated(NamedTuple):
    """What the model makes of a run, for each parameter set: arrays [sets, samples]."""

    current_a: Samples
    phase_rad: Samples
    park_steps: Samples


def simulate_run(
    run: Run, rows: NDArray[np.float64], starts: Samples, tables: NDArray[np.float64], threads: int | None = None
) -> Simulated:
    """Run a recording again with many parameter sets; `starts` is each one's number of its own start.

    The phase is the crank's angle, counted on from the start without wrapping.
    """
    rows = np.array(rows)
    rows[:, _STEP], rows[:, _BOUNCE], rows[:, _CIRCUIT] = run.period_s, 0.0, 0.0
    first = starts if run.start.at_rest else rows[:, _PARK_ANGLE] - rows[:, _HALF_WINDOW]
    states = _states(run, rows, first, starts)
    output = simulate_batch(states, run.inputs, rows, tables, COLUMNS, threads=threads)
    phase = _unwrapped(output[:, :, 1], first)
    return Simulated(output[:, :, 0], phase, _closings(output[:, :, 2]))


def _states(run: Run, rows: NDArray[np.float64], first: Samples, starts: Samples) -> NDArray[np.float64]:
    states = np.zeros((len(rows), len(STATE_PLACE)))
    states[:, STATE_PLACE["current_a"]] = run.start.current_a
    states[:, STATE_PLACE["park_contact"]] = run.start.contact
    states[:, STATE_PLACE["crank_angle_rad"]] = first % TURN_RAD
    if not run.start.at_rest:
        states[:, STATE_PLACE["motor_speed_rad_s"]] = starts * rows[:, _GEAR_RATIO]
    return states


def _unwrapped(angle_rad: Samples, first: Samples) -> Samples:
    """Count the crank's angle on over whole turns; it never moves by half a turn in one step."""
    moved = np.diff(angle_rad, axis=1)
    moved -= TURN_RAD * np.round(moved / TURN_RAD)
    phase = np.zeros_like(angle_rad)
    np.cumsum(moved, axis=1, out=phase[:, 1:])
    return np.asarray(phase + first[:, np.newaxis], np.float64)


def _closings(contact: Samples) -> Samples:
    closed = contact > 0.5
    rises = np.zeros_like(contact)
    rises[:, 1:] = closed[:, 1:] & ~closed[:, :-1]
    return np.asarray(np.cumsum(rises, axis=1), np.float64)


def samples_of(runs: Sequence[Run]) -> int:
    """Return how many samples count."""
    return int(sum(np.count_nonzero(run.valid) for run in runs))
