"""What stage 2 makes small: current and park steps, (5.24) to (5.26)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.identify.experiment import Run, samples_of, simulate_run
from hilplant.identify.parameters import Choice


class Parts(NamedTuple):
    """The two parts of the cost, each already divided by the number of samples: [sets]."""

    current: Floats  # mean square of the current's error [A2]
    park: Floats  # mean square of the park steps' error


@dataclass(frozen=True, slots=True)
class Cost:
    """The cost of parameter sets over all runs; one ampere weighs as much as one park step, as published.

    `threads` are those of one call; left out, as many as processors. It can be sent to another process.
    """

    runs: tuple[Run, ...]
    choice: Choice
    tables: Floats
    threads: int | None = None

    def __call__(self, sets: Floats) -> Floats:
        """Return (5.26) for sets of values [sets, parameters]."""
        parts = self.parts(sets)
        return parts.current + parts.park

    def parts(self, sets: Floats) -> Parts:
        """Return both parts; samples that are missing do not count."""
        rows, total = self.choice.rows(sets), samples_of(self.runs)
        current, park = np.zeros(len(sets)), np.zeros(len(sets))
        for run in self.runs:
            made = simulate_run(run, rows, np.full(len(sets), run.start.guess), self.tables, self.threads)
            current += _squares(made.current_a - run.current_a, run)
            park += _squares(made.park_steps - run.park_steps, run)
        return Parts(current / total, park / total)


def _squares(errors: Floats, run: Run) -> Floats:
    return np.asarray(np.einsum("ij,ij,j->i", errors, errors, run.valid.astype(np.float64)), np.float64)


def cost_of(runs: Sequence[Run], choice: Choice, tables: Floats) -> Cost:
    """Return the cost of `choice` over runs on this machine."""
    return Cost(tuple(runs), choice, tables)
