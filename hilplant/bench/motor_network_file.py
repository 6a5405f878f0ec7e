"""What the file of a motor network may say, and the row of numbers that compiled code makes of it."""

from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, model_validator

from hilplant.arrays import Floats
from hilplant.bench.load_files import TrainedFile
from hilplant.checked_yaml.checked import Checked, Name, NotNegative, Positive, Real, wrong

#: The first line's value in every such file.
FORMAT = "hilplant motor network 1"
#: What a path takes of a tick, in its order; the last two are what it answers.
QUANTITIES = ("terminal_v", "torque_n_m", "current_a", "crank_speed_rad_s")

Numbers = list[Real]
Pair = Annotated[list[Real], Field(min_length=2, max_length=2)]


class RangeSection(Checked):
    """Lowest and highest value of each quantity in the training: the scaling, and the limits of the guard."""

    terminal_v: Pair
    torque_n_m: Pair
    current_a: Pair
    crank_speed_rad_s: Pair

    @model_validator(mode="after")
    def _lowest_first(self) -> Self:
        for name in QUANTITIES:
            low, high = getattr(self, name)
            if not low < high:
                raise wrong(name, text=f"{name} must give its lowest value before its highest, not {low:g}, {high:g}")
        return self

    def array(self) -> Floats:
        """Return the ranges, [4, 2]."""
        return np.array([getattr(self, name) for name in QUANTITIES])


class PathSection(Checked):
    """The path of one brush: weights between scaled quantities, each of which its range takes to -1 and 1.

    A row of `hidden_weights` belongs to a neuron: voltage, torque, current, speed now, the same four a tick ago.
    """

    range: RangeSection
    hidden_weights: Annotated[list[Annotated[Numbers, Field(min_length=8, max_length=8)]], Field(min_length=1)]
    hidden_biases: Numbers
    output_weights: Annotated[list[Numbers], Field(min_length=2, max_length=2)]
    output_biases: Pair
    errors: dict[str, Any]

    @model_validator(mode="after")
    def _as_many_as_neurons(self) -> Self:
        neurons = len(self.hidden_weights)
        rows = [("hidden_biases", self.hidden_biases)] + [("output_weights", row) for row in self.output_weights]
        for name, found in rows:
            if len(found) != neurons:
                raise wrong(name, text=f"{name} must have {neurons} numbers, one for each neuron, not {len(found)}")
        return self

    def row(self) -> Floats:
        """Return the numbers in the order of :mod:`hilplant.models.narx`, scaling folded in."""
        ranges = self.range.array()
        gain = 2.0 / (ranges[:, 1] - ranges[:, 0])
        shift = -ranges[:, 0] * gain - 1.0
        inner, biases = np.array(self.hidden_weights), np.array(self.hidden_biases)
        outer, size = np.array(self.output_weights), 1.0 / gain[2:]
        inputs = 2.0 * inner * np.tile(gain, 2)
        firsts = 2.0 * (biases + inner @ np.tile(shift, 2))
        outputs = -2.0 * outer * size[:, np.newaxis]
        ends = (np.array(self.output_biases) + outer.sum(axis=1)) * size + ranges[2:, 0] + size
        neurons = np.hstack([firsts[:, np.newaxis], inputs, outputs.T])
        return np.concatenate([[float(len(biases))], ranges[:, 0], ranges[:, 1], ends, neurons.ravel()])


class BoundSection(Checked):
    """How far one tick of the network may be from the same tick of the physical model wherever it is active."""

    current_a: NotNegative
    crank_speed_rad_s: NotNegative


class MotorNetworkFile(TrainedFile):
    """A motor network with what it was trained for, on what, and how well it does."""

    motor: Name
    step_s: Positive
    seed: Annotated[int, Field(ge=0)]
    bound: BoundSection
    slow: PathSection
    fast: PathSection

    def row(self) -> Floats:
        """Return the numbers of both paths."""
        return np.concatenate([self.slow.row(), self.fast.row()])
