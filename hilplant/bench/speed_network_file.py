"""What the file of a speed network (section 7.5) may say, and the arrays that a controller reads of it."""

import hashlib
import json
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, model_validator

from hilplant.arrays import Floats
from hilplant.bench.load_files import TrainedFile
from hilplant.bench.motor_network_file import Numbers, Pair
from hilplant.checked_yaml.checked import Checked, Name, Positive, Real, wrong
from hilplant.models.records import Motor

#: The first line's value in every such file.
FORMAT = "hilplant speed network 1"
#: What a path takes in, and last what it answers.
SPEED_QUANTITIES = ("terminal_v", "current_a", "crank_speed_rad_s")


class SpeedRange(Checked):
    """Lowest and highest value of each quantity in the training, which stand for -1 and 1."""

    terminal_v: Pair
    current_a: Pair
    crank_speed_rad_s: Pair

    @model_validator(mode="after")
    def _lowest_first(self) -> Self:
        for name in SPEED_QUANTITIES:
            low, high = getattr(self, name)
            if not low < high:
                raise wrong(name, text=f"{name} must give its lowest value before its highest, not {low:g}, {high:g}")
        return self


class SpeedPathSection(Checked):
    """The path of one brush; a row of `hidden` is a neuron: weights of voltage and current, and its bias."""

    range: SpeedRange
    hidden: Annotated[list[Annotated[Numbers, Field(min_length=3, max_length=3)]], Field(min_length=1, max_length=64)]
    output: Numbers
    output_bias: Real
    errors: dict[str, Any]

    @model_validator(mode="after")
    def _as_many_as_neurons(self) -> Self:
        if len(self.output) != len(self.hidden):
            text = f"output must have {len(self.hidden)} numbers, one for each neuron, not {len(self.output)}"
            raise wrong("output", text=text)
        return self

    def path(self) -> Floats:
        """Return the array of :func:`hilplant.control.network.network_speed`."""
        path = np.zeros((len(self.hidden) + 3, 4))
        for row, name in enumerate(SPEED_QUANTITIES):
            low, high = getattr(self.range, name)
            path[row, :2] = 0.5 * (low + high), 0.5 * (high - low)
        path[0, 3] = self.output_bias
        path[3:, :3], path[3:, 3] = self.hidden, self.output
        return path


class SpeedNetworkFile(TrainedFile):
    """A speed network with what it was trained for, on what, and how well it does."""

    motor: Name
    step_s: Positive
    seed: Annotated[int, Field(ge=0)]
    slow: SpeedPathSection
    fast: SpeedPathSection

    def paths(self) -> tuple[Floats, Floats]:
        """Return the arrays of the slow and of the fast brush."""
        return self.slow.path(), self.fast.path()


def motor_record_hash(motor: Motor) -> str:
    """Return the hash of a motor's numbers, by which a controller tells that a network belongs to its motor."""
    return hashlib.sha256(json.dumps(motor).encode()).hexdigest()
