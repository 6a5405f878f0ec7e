"""A measurement as something that a bench can run again: inputs, start, and what is compared.

The measured terminal voltage drives the model: a relay that grounds the brush and a supply of 0 V are the same circuit.
A run begins at rest, or at the first park edge where the recording begins in motion. One number of its start is not
measured and is looked for with the parameters: the crank's angle at rest, else its speed at the edge. So is the offset
that is left in the current.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hilplant.arrays import Flags, Floats
from hilplant.models.records import PARAMETER_INDEX, STATE_INDEX
from hilplant.simulation.batch import simulate_batch
from hilplant.units import TURN_RAD

COLUMNS = ("current_a", "crank_angle_rad", "park_contact")

_STEP, _GEAR_RATIO = PARAMETER_INDEX["step_s"], PARAMETER_INDEX["motor.gear_ratio"]
_PARK_ANGLE, _HALF_WINDOW = PARAMETER_INDEX["park_switch.angle_rad"], PARAMETER_INDEX["park_switch.half_window_rad"]
_BOUNCE, _CIRCUIT = PARAMETER_INDEX["park_switch.bounce_ticks"], PARAMETER_INDEX["park_switch.circuit"]


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
    inputs: Floats
    current_a: Floats
    voltage_v: Floats
    park: Floats
    valid: Flags
    period_s: float
    start: Start
    edges: NDArray[np.intp]
    edge_angles_rad: Floats
    edge_speeds_rad_s: Floats

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.current_a)

    @property
    def time_s(self) -> Floats:
        """Time from the start of the run."""
        return np.asarray(np.arange(len(self)) * self.period_s, np.float64)

    @property
    def park_steps(self) -> Floats:
        """How often the contact has closed since the start, section 5.2."""
        steps = np.zeros(len(self))
        steps[self.edges] = 1.0
        return np.cumsum(steps)


class Simulated(NamedTuple):
    """What the model makes of a run, for each parameter set: arrays [sets, samples]."""

    current_a: Floats
    phase_rad: Floats
    park_steps: Floats


def simulate_run(run: Run, rows: Floats, starts: Floats, tables: Floats, threads: int | None = None) -> Simulated:
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


def _states(run: Run, rows: Floats, first: Floats, starts: Floats) -> Floats:
    states = np.zeros((len(rows), len(STATE_INDEX)))
    states[:, STATE_INDEX["current_a"]] = run.start.current_a
    states[:, STATE_INDEX["park_contact"]] = run.start.contact
    states[:, STATE_INDEX["crank_angle_rad"]] = first % TURN_RAD
    if not run.start.at_rest:
        states[:, STATE_INDEX["motor_speed_rad_s"]] = starts * rows[:, _GEAR_RATIO]
    return states


def _unwrapped(angle_rad: Floats, first: Floats) -> Floats:
    """Count the crank's angle on over whole turns; it never moves by half a turn in one step."""
    moved = np.diff(angle_rad, axis=1)
    moved -= TURN_RAD * np.round(moved / TURN_RAD)
    phase = np.zeros_like(angle_rad)
    np.cumsum(moved, axis=1, out=phase[:, 1:])
    return np.asarray(phase + first[:, np.newaxis], np.float64)


def _closings(contact: Floats) -> Floats:
    closed = contact > 0.5
    rises = np.zeros_like(contact)
    rises[:, 1:] = closed[:, 1:] & ~closed[:, :-1]
    return np.asarray(np.cumsum(rises, axis=1), np.float64)


def samples_of(runs: Sequence[Run]) -> int:
    """Return how many samples count."""
    return int(sum(np.count_nonzero(run.valid) for run in runs))
