"""Training of one path of the motor network: open loop first, then closed loop from there, section 6.4.3."""

import time
from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Flags, Floats
from hilplant.progress import OnProgress, ProgressReport
from hilplant.train.levenberg_marquardt import DescentSettings, minimise
from hilplant.train.motor_data import DrivenSequence
from hilplant.train.motor_loop import WIDTH, room_for, run, weight_count

#: Neurons of each path, by the listing of Appendix F.
NEURONS = {"slow": 10, "fast": 8}
#: Noise on what the network reads in open loop as current and speed of the tick before, scaled. Without it nothing says
#: how much to trust these, as they can be computed from the present ones: a network that overrates them runs away in
#: closed loop.
NOISE = 0.03

#: The stages: for how many ticks the network reads its own answers, and when to stop. The first is the open loop, the
#: last the closed one; those between keep it from running away.
ENDLESS = 10**9
OPEN = (1, DescentSettings(epochs=40, patience=15, decay=0.0, first_damping=1e-3))
CLOSED = (
    (20, DescentSettings(epochs=15, patience=8, decay=0.0, first_damping=1e-3)),
    (ENDLESS, DescentSettings(epochs=60, patience=15, decay=0.0, first_damping=1e-3)),
)


@dataclass(frozen=True, slots=True)
class MotorScaling:
    """The ranges [4, 2] of voltage, torque, current and speed that are taken to -1 and 1."""

    ranges: Floats

    @classmethod
    def of(cls, sequence: DrivenSequence) -> "MotorScaling":
        """Return the ranges of the ticks that training uses, with the ticks before and after them."""
        training = sequence.parts()[0]
        used = training.copy()
        used[:-1] |= training[1:]
        used[:-2] |= training[2:]
        values = np.hstack([sequence.inputs, sequence.outputs])[used]
        return cls(np.stack([values.min(axis=0), values.max(axis=0)], axis=1))

    def scaled(self, values: Floats, first: int) -> Floats:
        """Take two columns, of which the first is quantity `first`, to [-1, 1]."""
        low, high = self.ranges[first : first + 2].T
        result: Floats = 2.0 * (values - low) / (high - low) - 1.0
        return result

    @property
    def output_sizes(self) -> Floats:
        """Half the ranges of current [A] and speed [rad/s]: what 1 stands for."""
        sizes: Floats = 0.5 * (self.ranges[2:, 1] - self.ranges[2:, 0])
        return sizes


@dataclass
class MotorFit:
    """A path with its data, for :func:`minimise`."""

    sequence: DrivenSequence
    scaling: MotorScaling
    horizon: int
    noise: Floats | None = None

    def __post_init__(self) -> None:
        """Scale once; keep room for the derivatives."""
        self._inputs = self.scaling.scaled(self.sequence.inputs, 0)
        self._outputs = self.scaling.scaled(self.sequence.outputs, 2)
        self._earlier = self._outputs if self.noise is None else self._outputs + self.noise
        self._training, self._validation, _ = self.sequence.parts()
        self._jacobian = np.zeros((0, 2, 0))

    def _run(self, weights: Floats, jacobian: Floats) -> Floats:
        predicted = np.empty_like(self._outputs)
        room = np.zeros(room_for(len(weights)))
        known, earlier = self.sequence.known, self._earlier
        run(weights, self._inputs, self._outputs, earlier, known, self.horizon, predicted, jacobian, room)
        errors: Floats = predicted - self._outputs
        return errors

    def cost(self, weights: Floats) -> float:
        """Return the sum of the squared residuals of training; endless when the loop runs away."""
        errors = self._run(weights, np.zeros((0, 2, len(weights))))[self._training]
        total = float(np.sum(errors * errors))
        return total if np.isfinite(total) else np.inf

    def normal(self, weights: Floats) -> tuple[float, Floats, Floats]:
        """Return the sum of the squared residuals, J'J and J'r."""
        if self._jacobian.shape[2] != len(weights):
            self._jacobian = np.zeros((len(self._outputs), 2, len(weights)))
        errors = self._run(weights, self._jacobian)[self._training].ravel()
        rows = self._jacobian[self._training].reshape(len(errors), len(weights))
        return float(errors @ errors), rows.T @ rows, rows.T @ errors

    def judged(self, weights: Floats) -> float:
        """Return the mean squared error of validation."""
        errors = self._run(weights, np.zeros((0, 2, len(weights))))[self._validation]
        error = float(np.mean(errors * errors))
        return error if np.isfinite(error) else np.inf

    def errors(self, weights: Floats) -> Floats:
        """Return the errors of all ticks in A and rad/s, [n, 2]."""
        return self._run(weights, np.zeros((0, 2, len(weights)))) * self.scaling.output_sizes


@dataclass(frozen=True, slots=True)
class TrainedPath:
    """A path after training: its weights after open and after closed loop, and what each took."""

    brush: str
    sequence: DrivenSequence
    scaling: MotorScaling
    open_weights: Floats
    weights: Floats
    epochs: tuple[int, int]
    seconds: tuple[float, float]
    interrupted: bool

    def errors(self, closed: bool, after_closed: bool = True) -> Floats:
        """Return the errors in A and rad/s of the weights after closed-loop or after open-loop training, run so."""
        horizon = ENDLESS if closed else 1
        return MotorFit(self.sequence, self.scaling, horizon).errors(
            self.weights if after_closed else self.open_weights
        )


def first_weights(neurons: int, random: np.random.Generator) -> Floats:
    """Return weights to begin with, by Nguyen and Widrow (1990), as initnw of the thesis' listing does."""
    size = 0.7 * neurons ** (1.0 / WIDTH)
    inner = random.uniform(-1.0, 1.0, (neurons, WIDTH))
    inner *= size / np.linalg.norm(inner, axis=1, keepdims=True)
    biases = size * np.linspace(-1.0, 1.0, neurons) * np.sign(inner[:, 0])
    weights = np.zeros(weight_count(neurons))
    weights[: 9 * neurons] = np.concatenate([inner.ravel(), biases])
    weights[9 * neurons : 11 * neurons] = random.uniform(-0.5, 0.5, 2 * neurons)
    return weights


def train_path(
    brush: str, sequence: DrivenSequence, random: np.random.Generator, on_progress: OnProgress
) -> TrainedPath:
    """Train a path; Ctrl-C ends it with the best weights so far."""
    scaling = MotorScaling.of(sequence)
    weights = first_weights(NEURONS[brush], random)
    stages = (OPEN, *CLOSED)
    epochs, seconds, open_weights, stopped = [0, 0], [0.0, 0.0], weights, False
    for index, (horizon, settings) in enumerate(stages):
        noise = NOISE * random.standard_normal(sequence.outputs.shape) if index == 0 else None
        stage = _Stage(MotorFit(sequence, scaling, horizon, noise), settings, f"{brush}, {_named(horizon)}")
        weights, stopped = stage.run(weights, on_progress)
        epochs[min(index, 1)] += stage.epochs
        seconds[min(index, 1)] += stage.seconds
        if index == 0:
            open_weights = weights
        if stopped:
            break
    counted, taken = (epochs[0], epochs[1]), (seconds[0], seconds[1])
    return TrainedPath(brush, sequence, scaling, open_weights, weights, counted, taken, stopped)


def _named(horizon: int) -> str:
    return {1: "open loop", ENDLESS: "closed loop"}.get(horizon, f"closed for {horizon} ticks")


@dataclass
class _Stage:
    """One call of :func:`minimise`, which Ctrl-C ends with the best weights so far."""

    fit: MotorFit
    settings: DescentSettings
    name: str
    epochs: int = 0
    seconds: float = 0.0

    def run(self, start: Floats, on_progress: OnProgress) -> tuple[Floats, bool]:
        """Return the best weights, and whether Ctrl-C came."""
        begin = time.perf_counter()

        def told(epoch: int, judged: float) -> None:
            self.epochs = epoch
            note = f"epoch {epoch}, validation {judged:.2g}"
            on_progress(ProgressReport(self.name, epoch, self.settings.epochs, note))

        minimum = minimise(self.fit, start, self.settings, told)
        self.seconds = time.perf_counter() - begin
        return minimum.weights, minimum.interrupted


def part_errors(errors: Floats, part: Flags) -> Floats:
    """Return the mean squares of the errors of current and speed in a part of the data."""
    squares: Floats = np.mean(errors[part] ** 2, axis=0)
    return squares
