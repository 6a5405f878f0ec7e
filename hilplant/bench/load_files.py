"""What the trained files of loads may say, and the row of numbers that the step reads of them."""

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from hilplant.arrays import Floats
from hilplant.checked_yaml.checked import Checked, Name, NotNegative, Positive, Real, wrong

TORQUE_FORMAT = "hilplant torque network 1"
POLYNOMIAL_FORMAT = "hilplant no-load polynomial 1"

#: How much of the trained speeds must be left at both ends before the network is trusted again, as a part of them.
RETURN_MARGIN = 0.02

Range = Annotated[list[Real], Field(min_length=2, max_length=2)]
Numbers = Annotated[list[Real], Field(min_length=1)]


class Scaling(Checked):
    """What stands for -1 and +1: lowest and highest speed of the training, least and largest torque."""

    speed_rad_s: Range
    dry_n_m: Range
    wet_n_m: Range


class Bounds(Checked):
    """Largest errors against the physical load over a dense grid, and a little more [N m]."""

    dry_n_m: Positive
    wet_n_m: Positive


class TrainedFile(Checked):
    """What every trained file tells of itself."""

    format: Name
    bench: Name
    command: Name
    version: Name
    parameter_hash: Name
    data_hash: Name
    content_hash: Name


class TorqueFile(TrainedFile):
    """A torque network: scaling and weights; each row of `hidden` and `output` ends with its bias.

    With `harmonics` 0 the inputs are angle and speed, both scaled to [-1, 1]; else sines and cosines of the angle and
    its multiples up to `harmonics`, and the scaled speed.
    """

    seed: int
    harmonics: Literal[0, 1, 2]
    training: dict[str, Numbers | int]
    scaling: Scaling
    hidden: Annotated[list[Numbers], Field(min_length=1, max_length=64)]
    output: Annotated[list[Numbers], Field(min_length=2, max_length=2)]
    errors: dict[str, NotNegative]
    bounds: Bounds

    @model_validator(mode="after")
    def _fit_each_other(self) -> Self:
        inputs = max(1, 2 * self.harmonics) + 1
        for number, row in enumerate(self.hidden):
            if len(row) != inputs + 1:
                raise wrong("hidden", number, text=f"a neuron has {inputs} weights and a bias, not {len(row)} numbers")
        for number, row in enumerate(self.output):
            if len(row) != len(self.hidden) + 1:
                text = f"an output has {len(self.hidden)} weights and a bias, not {len(row)} numbers"
                raise wrong("output", number, text=text)
        for name, limits in (
            ("speed_rad_s", self.scaling.speed_rad_s),
            ("dry_n_m", self.scaling.dry_n_m),
            ("wet_n_m", self.scaling.wet_n_m),
        ):
            if not limits[0] < limits[1]:
                raise wrong("scaling", name, text=f"{name} must be a lower and a higher number")
        return self

    def numbers(self) -> Floats:
        """Return the row that :mod:`hilplant.models.torque_network` reads, scaling contained in the weights."""
        low, high = self.scaling.speed_rad_s
        hidden, output = np.array(self.hidden), np.array(self.output)
        speed_scale = 2.0 / (high - low)
        neurons = np.zeros((len(hidden), 9))
        angles = hidden[:, :-2]
        if self.harmonics == 0:
            neurons[:, 0] = angles[:, 0] / np.pi
        neurons[:, 1 : 1 + 2 * self.harmonics] = angles if self.harmonics else 0.0
        neurons[:, 5] = hidden[:, -2] * speed_scale
        neurons[:, 6] = hidden[:, -1] - hidden[:, -2] * (1.0 + low * speed_scale)
        neurons[:, 6] -= angles[:, 0] if self.harmonics == 0 else 0.0
        neurons[:, :7] *= 2.0
        first = []
        for column, limits, weights in zip((7, 8), (self.scaling.dry_n_m, self.scaling.wet_n_m), output, strict=True):
            half, middle = 0.5 * (limits[1] - limits[0]), 0.5 * (limits[1] + limits[0])
            neurons[:, column] = -2.0 * half * weights[:-1]
            first.append(middle + half * weights.sum())
        head = [float(len(hidden)), low, high, RETURN_MARGIN * (high - low), *first]
        row = np.concatenate([head, neurons.ravel()])
        return np.concatenate([[float(len(row))], row])


class PolynomialFile(TrainedFile):
    """The polynomials (6.1), (6.2) of a linkage, constants first, and the constants of (6.3)."""

    forward: Annotated[list[Real], Field(min_length=5, max_length=5)]
    reverse: Annotated[list[Real], Field(min_length=8, max_length=8)]
    c1: Real
    c2: NotNegative
    training: dict[str, Numbers | int]
    errors: dict[str, NotNegative]

    def numbers(self) -> Floats:
        """Return the row that :mod:`hilplant.models.polynomial` reads."""
        return np.array([float(len(self.forward) + len(self.reverse)), *self.forward, *self.reverse])
