"""What stage 3 makes small: current errors, and how late or early the crank is at each park edge.

The park contact itself jumps from one sample to the next, so no derivative can be had from it. The crank's phase in the
model at the instant of a measured edge is smooth: its distance from the angle at which the contact closes, over the
crank's speed, is a time error. A measured edge lies, on average, half a sample before the sample that shows it.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hilplant.arrays import Floats
from hilplant.identify.experiment import Run, simulate_run
from hilplant.identify.parameters import Choice

#: First steps of the finite differences, in units of an unknown's scale, and the longest of later ones.
FIRST_STEP, LONGEST_STEP = 1e-4, 0.05

#: Speed of the crank at a park edge, in parts of the mean speed of its turn, below which time errors are unknown.
SLOWEST_PART = 0.3
#: Offset that may be left in a current once the one at rest has been taken off [A].
MOST_OFFSET_A = 0.1


class ResidualNoise(NamedTuple):
    """Standard deviations by which residuals are weighted: current [A], time of a park edge [s]."""

    current_a: float
    edge_s: float


class LeastSquares:
    """Runs and parameters as one vector of unknowns: parameters, then offset and start of each run, all scaled.

    Unknown x stands for `scale` x. Residuals have standard deviation 1 where the model is right.
    """

    def __init__(
        self, runs: Sequence[Run], choice: Choice, tables: Floats, noise: ResidualNoise, scale: Floats
    ) -> None:
        self.runs, self.choice, self.tables, self.noise = tuple(runs), choice, tables, noise
        starts = [0.1 * (run.start.high - run.start.low) for run in runs]
        self.scale = np.concatenate([scale, np.full(len(runs), noise.current_a), starts])
        self.parameters = len(choice)

    def start(self, values: Floats) -> Floats:
        """Return the scaled unknowns for parameter values, with offsets 0 and each run's guess of its start."""
        guesses = [run.start.guess for run in self.runs]
        return np.asarray(np.concatenate([values, np.zeros(len(self.runs)), guesses]) / self.scale, np.float64)

    def bounds(self, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        """Return scaled bounds of all unknowns for those of the parameters."""
        offset = np.full(len(self.runs), MOST_OFFSET_A)
        lows = np.concatenate([low, -offset, [run.start.low for run in self.runs]])
        highs = np.concatenate([high, offset, [run.start.high for run in self.runs]])
        return lows / self.scale, highs / self.scale

    def values(self, x: Floats) -> Floats:
        """Return the parameters' values."""
        return np.asarray((x * self.scale)[: self.parameters], np.float64)

    def with_noise(self, noise: ResidualNoise) -> "LeastSquares":
        """Return the same problem with other weights; unknowns keep their scales."""
        other = LeastSquares(self.runs, self.choice, self.tables, noise, self.scale[: self.parameters])
        other.scale = self.scale
        return other

    def localised(self, x: Floats) -> "LeastSquares":
        """Return the same problem with the crank's speed at each edge as the model has it at `x`.

        A mean speed serves until then: far from the solution the model may stand still at an edge.
        """
        values, count = x * self.scale, len(self.runs)
        row = self.choice.rows(values[np.newaxis, : self.parameters])
        runs = []
        for place, run in enumerate(self.runs):
            phase = simulate_run(run, row, values[[self.parameters + count + place]], self.tables).phase_rad[0]
            speeds = (phase[run.edges] - phase[run.edges - 1]) / run.period_s
            least = SLOWEST_PART * run.edge_speeds_rad_s
            runs.append(replace(run, edge_speeds_rad_s=np.maximum(speeds, least)))
        other = LeastSquares(runs, self.choice, self.tables, self.noise, self.scale[: self.parameters])
        other.scale = self.scale
        return other

    def simulated(self, sets: Floats) -> Floats:
        """Return the residuals [sets, residuals] of scaled unknowns [sets, unknowns], in one batch for each run."""
        values = sets * self.scale
        rows, count = self.choice.rows(values[:, : self.parameters]), len(self.runs)
        parts = []
        for place, run in enumerate(self.runs):
            offset = values[:, self.parameters + place]
            start = values[:, self.parameters + count + place]
            parts.append(self._of_run(run, rows, offset, start))
        return np.concatenate(parts, axis=1)

    def _of_run(self, run: Run, rows: Floats, offset: Floats, start: Floats) -> Floats:
        made = simulate_run(run, rows, start, self.tables)
        current = made.current_a + offset[:, np.newaxis] - run.current_a
        late_s = edge_errors_s(run, made.phase_rad)
        return np.hstack([current[:, run.valid] / self.noise.current_a, late_s / self.noise.edge_s])

    def residuals(self, x: Floats) -> Floats:
        """Return the residuals of one set."""
        return np.asarray(self.simulated(x[np.newaxis])[0], np.float64)

    def jacobian(self, x: Floats, basis: Floats | None = None) -> Floats:
        """Return the derivatives [residuals, unknowns] by central differences, all evaluated in one batch.

        The columns of `basis` are the directions and steps in which the unknowns but the offsets are moved; left out,
        each is moved alone by `FIRST_STEP`. Derivatives by the offsets are known and cost nothing.
        """
        moved = self.moved
        if basis is None:
            basis = np.diag(FIRST_STEP * np.maximum(np.abs(x[moved]), 1.0))
        basis = self._within_nature(x, basis)
        sets = np.repeat(x[np.newaxis], 2 * len(moved), axis=0)
        sets[0::2, moved] += basis.T
        sets[1::2, moved] -= basis.T
        made = self.simulated(sets)
        columns = np.zeros((made.shape[1], len(x)))
        columns[:, moved] = np.linalg.solve(basis.T, 0.5 * (made[0::2] - made[1::2])).T
        self._fill_offsets(columns)
        return columns

    def _within_nature(self, x: Floats, basis: Floats) -> Floats:
        """Shorten directions that would take a parameter below 0: with such an inductance a current grows for ever."""
        farthest = np.full(len(self.moved), np.inf)
        for place, parameter in enumerate(self.choice.parameters):
            if not parameter.signed:
                farthest[place] = max(0.5 * x[place], FIRST_STEP)
        return np.asarray(basis / np.maximum(1.0, np.max(np.abs(basis) / farthest[:, np.newaxis], axis=0)), np.float64)

    @property
    def moved(self) -> NDArray[np.intp]:
        """The unknowns that need simulations: all but the offsets."""
        return np.array([place for place in range(len(self.scale)) if not self._is_offset(place)])

    def _is_offset(self, place: int) -> bool:
        return self.parameters <= place < self.parameters + len(self.runs)

    def _fill_offsets(self, columns: Floats) -> None:
        for place, (current, _) in enumerate(self.parts()):
            column = self.parameters + place
            columns[current, column] = self.scale[column] / self.noise.current_a

    def parts(self) -> list[tuple[slice, slice]]:
        """Return where each run's currents and edges are among the residuals."""
        slices, begin = [], 0
        for run in self.runs:
            currents, edges = int(np.count_nonzero(run.valid)), len(run.edges)
            slices.append((slice(begin, begin + currents), slice(begin + currents, begin + currents + edges)))
            begin += currents + edges
        return slices


def directions(jacobian: Floats) -> Floats:
    """Return a basis for differences: along each singular vector, as far as changes the residuals by 1 in all.

    Differences parameter by parameter cannot see what a combination does in which large effects cancel: where a rocker
    turns round, and where the shaft stops, the model's derivative jumps a little from tick to tick, and that is more
    than what is left over. Along the combination itself nothing large is there to jump.
    """
    _, size, vectors = np.linalg.svd(np.linalg.qr(jacobian, mode="r"))
    steps = np.minimum(1.0 / np.maximum(size, 1e-12), LONGEST_STEP / np.max(np.abs(vectors), axis=1))
    return np.asarray(vectors.T * steps, np.float64)


def edge_errors_s(run: Run, phase_rad: Floats) -> Floats:
    """Return by how much the model is early at each park edge [s], [sets, edges]."""
    half_way = 0.5 * (phase_rad[:, run.edges - 1] + phase_rad[:, run.edges])
    return np.asarray((half_way - run.edge_angles_rad) / run.edge_speeds_rad_s, np.float64)


def expected_noise(runs: Sequence[Run]) -> ResidualNoise:
    """Return weights to begin with: the current's restlessness from sample to sample, and a park edge's rounding."""
    changes = np.concatenate([np.diff(run.current_a, n=2)[run.valid[1:-1]] for run in runs])
    current_a = 1.4826 * float(np.median(np.abs(changes))) / np.sqrt(6.0)
    return ResidualNoise(max(current_a, 1e-3), max(run.period_s for run in runs) / np.sqrt(12.0))
