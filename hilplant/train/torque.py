"""Training of the torque network of section 6.4.2: several starts, the best by data that no fit has seen."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import numpy as np
from threadpoolctl import threadpool_limits

from hilplant.arrays import Floats, Whole
from hilplant.bench.assembly import Bench
from hilplant.progress import OnProgress, ProgressReport, unseen
from hilplant.train.levenberg_marquardt import DescentSettings, Minimum, minimise
from hilplant.train.tanh_network import NetworkFit, Samples, TanhNetwork
from hilplant.train.torque_data import Speeds, Wipes, wipes

#: Parts of the samples that are fitted and judged by; the rest is the test.
TRAINED, JUDGED = 0.70, 0.15


@dataclass(frozen=True, slots=True)
class TrainingPlan:
    """What to train: neurons, inputs, data, and how many starts from which seed."""

    neurons: int = 10
    harmonics: int = 2
    speeds: Speeds = field(default_factory=lambda: Speeds((1.0, 3.0, 5.0, 7.0)))
    points: int = 250
    starts: int = 10
    seed: int = 1
    settings: DescentSettings = field(default_factory=lambda: DescentSettings(first_decay=10.0))


@dataclass(frozen=True, slots=True)
class Data:
    """Samples of one bench: of the training, of the choice among fits, and of the separate validation."""

    training: Wipes
    judging: Wipes
    validation: Wipes


@dataclass(frozen=True, slots=True)
class Scale:
    """What stands for -1 and +1: speeds [2], torques [2, outputs]."""

    speeds: Floats
    torques: Floats

    def inputs(self, states: Floats, harmonics: int) -> Floats:
        """Return what the network takes: angle or its sines and cosines, and speed, all in [-1, 1]."""
        angle = states[:, 0]
        speed = 2.0 * (states[:, 1] - self.speeds[0]) / (self.speeds[1] - self.speeds[0]) - 1.0
        circles = [bend(k * angle) for k in range(1, harmonics + 1) for bend in (np.sin, np.cos)]
        return np.column_stack([*(circles or [angle / np.pi - 1.0]), speed])

    def targets(self, torques: Floats) -> Floats:
        """Return torques scaled to [-1, 1]."""
        scaled: Floats = 2.0 * (torques - self.torques[0]) / np.ptp(self.torques, axis=0) - 1.0
        return scaled

    def torques_of(self, outputs: Floats) -> Floats:
        """Return torques [N m] from what the network gives."""
        scaled: Floats = self.torques[0] + 0.5 * (outputs + 1.0) * np.ptp(self.torques, axis=0)
        return scaled


@dataclass(frozen=True, slots=True)
class FitErrors:
    """Mean squared errors [(N m)^2] of the four sets of Table 6-1 and of the separate validation."""

    train: float
    validate: float
    test: float
    total: float
    validation: float


@dataclass(frozen=True, slots=True)
class TrainedTorque:
    """A network with its scale and errors; `epochs` of its own fit."""

    plan: TrainingPlan
    network: TanhNetwork
    scale: Scale
    weights: Floats
    errors: FitErrors
    epochs: int
    judged: float
    interrupted: bool

    def torques(self, states: Floats) -> Floats:
        """Return the torques [N m], dry and wet, at angles and speeds [m, 2]."""
        return self.scale.torques_of(self.network.answer(self.weights, self.scale.inputs(states, self.plan.harmonics)))


def data_of(bench: Bench, plan: TrainingPlan) -> Data:
    """Return all samples of a bench."""
    speeds = plan.speeds
    kinds = (speeds.training, speeds.judging, speeds.validation)
    return Data(*(wipes(bench, kind, plan.points) for kind in kinds))


def train(data: Data, plan: TrainingPlan, on_progress: OnProgress = unseen) -> TrainedTorque:
    """Return the best of several trainings; an interrupt keeps the best so far.

    `on_progress` is told of each epoch; starts are counted.
    """
    best: TrainedTorque | None = None
    with one_thread():
        for start in range(plan.starts):
            trained = train_once(data, plan, start, on_progress)
            if best is None or trained.judged < best.judged:
                best = trained
            if trained.interrupted:
                return replace(best, interrupted=True)
    if best is None:
        raise ValueError("a plan needs at least one start")
    return best


@contextmanager
def one_thread() -> Iterator[None]:
    """Keep matrix products on one thread: faster for small ones, and the same digits wherever there are more."""
    with threadpool_limits(limits=1):
        yield


def train_once(data: Data, plan: TrainingPlan, start: int, on_progress: OnProgress = unseen) -> TrainedTorque:
    """Return one training; its split and its first weights come from the plan's seed and the start's number."""
    random = np.random.default_rng([plan.seed, plan.neurons, start])
    torques = data.training.torques
    scale = Scale(np.array(plan.speeds.training)[[0, -1]], np.array([torques.min(axis=0), torques.max(axis=0)]))
    samples, judging = (_scaled(scale, part, plan) for part in (data.training, data.judging))
    order = random.permutation(len(torques))
    cuts = [round(TRAINED * len(order)), round((TRAINED + JUDGED) * len(order))]
    sets = np.split(order, cuts)
    kept = samples.taken(sets[1])
    both = Samples(np.concatenate([kept.inputs, judging.inputs]), np.concatenate([kept.targets, judging.targets]))
    network = TanhNetwork(samples.inputs.shape[1], plan.neurons, torques.shape[1])
    fit = NetworkFit(network, samples.taken(sets[0]), both)

    def tell(epoch: int, judged: float) -> None:
        note = f"epoch {epoch}, judged {judged:.2g}"
        on_progress(ProgressReport("torque network, starts", start, plan.starts, note))

    minimum = minimise(fit, network.start(random), plan.settings, tell)
    return _with_errors(data, plan, minimum, (network, scale, sets))


def _scaled(scale: Scale, part: Wipes, plan: TrainingPlan) -> Samples:
    return Samples(scale.inputs(part.states, plan.harmonics), scale.targets(part.torques))


def _with_errors(
    data: Data, plan: TrainingPlan, minimum: Minimum, made: tuple[TanhNetwork, Scale, list[Whole]]
) -> TrainedTorque:
    network, scale, sets = made
    none = FitErrors(0.0, 0.0, 0.0, 0.0, 0.0)
    trained = TrainedTorque(
        plan, network, scale, minimum.weights, none, minimum.epochs, minimum.judged, minimum.interrupted
    )
    squared = (trained.torques(data.training.states) - data.training.torques) ** 2
    parts = [float(squared[rows].mean()) for rows in sets]
    separate = float(np.mean((trained.torques(data.validation.states) - data.validation.torques) ** 2))
    errors = FitErrors(parts[0], parts[1], parts[2], float(squared.mean()), separate)
    return replace(trained, errors=errors)
