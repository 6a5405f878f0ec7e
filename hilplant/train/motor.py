"""`hilplant train motor`: data from the physical plant, training, errors, the bound of the guard, and one file."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hilplant import __version__
from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.bench.motor_network_file import FORMAT, QUANTITIES, PathSection
from hilplant.bench.parameter_hash import motor_hash
from hilplant.progress import OnProgress
from hilplant.train.motor_data import LENGTH_S, DrivenSequence, recorded
from hilplant.train.motor_figures import path_figures
from hilplant.train.motor_fit import TrainedPath, train_path
from hilplant.train.motor_search import OneTickErrors, search
from hilplant.train.torque import one_thread
from hilplant.train.writing import data_hash, write_file

#: Scenarios searched for the bound, and what the largest difference found is multiplied by to be the bound.
SEARCHED, SAFETY = 3000, 2.0


@dataclass(frozen=True, slots=True)
class MotorNetwork:
    """A trained network: both paths, the numbers of its row, what the search found, and what is written."""

    paths: tuple[TrainedPath, ...]
    networks: Floats
    found: OneTickErrors
    content: dict[str, Any]

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C ended the training early."""
        return any(path.interrupted for path in self.paths)


def train_motor(
    bench: Bench, seed: int, command: str, on_progress: OnProgress, own: Mapping[str, DrivenSequence] | None = None
) -> MotorNetwork:
    """Train both paths for the motor of a bench; the same seed gives the same numbers.

    A brush of which there are `own` data learns from them, the other from what the bench's plant does.
    Ctrl-C ends the stage of training that runs, and each that follows, with the best weights so far.
    """
    paths = []
    for index, brush in enumerate(("slow", "fast")):
        sequence = (own or {}).get(brush)
        if sequence is None:
            sequence = recorded(bench, brush, LENGTH_S, np.random.default_rng([seed, index, 0]))
        with one_thread():
            paths.append(train_path(brush, sequence, np.random.default_rng([seed, index, 1]), on_progress))
    sections = {path.brush: _section(path) for path in paths}
    rows = [PathSection.model_validate(section).row() for section in sections.values()]
    networks = np.concatenate([[0.0], *rows])
    found = search(bench, networks, SEARCHED, seed)
    content = {
        "format": FORMAT,
        "bench": bench.name,
        "command": command,
        "version": __version__,
        "parameter_hash": motor_hash(bench.plant.motor),
        "data_hash": data_hash(*(array for path in paths for array in (path.sequence.inputs, path.sequence.outputs))),
        "motor": bench.plant.motor.name,
        "step_s": bench.parameters.step_s,
        "seed": seed,
        "bound": {
            "current_a": _upwards(SAFETY * found.current_a),
            "crank_speed_rad_s": _upwards(SAFETY * found.crank_speed_rad_s),
        },
        **sections,
    }
    return MotorNetwork(tuple(paths), networks, found, content)


def write_network(network: MotorNetwork, path: Path) -> None:
    """Write the file that a bench names."""
    write_file(path, network.content)


def _section(path: TrainedPath) -> dict[str, Any]:
    weights = path.weights
    neurons = (len(weights) - 2) // 11
    inner, biases = weights[: 8 * neurons].reshape(neurons, 8), weights[8 * neurons : 9 * neurons]
    outer, ends = weights[9 * neurons : 11 * neurons].reshape(2, neurons), weights[11 * neurons :]
    return {
        "range": {name: limits.tolist() for name, limits in zip(QUANTITIES, path.scaling.ranges, strict=True)},
        "hidden_weights": inner.tolist(),
        "hidden_biases": biases.tolist(),
        "output_weights": outer.tolist(),
        "output_biases": ends.tolist(),
        "errors": path_figures(path),
    }


def _upwards(number: float) -> float:
    """Return the number with two digits, rounded up."""
    exponent = int(np.floor(np.log10(number))) - 1
    return float(f"{np.ceil(number / 10.0**exponent) * 10.0**exponent:.2g}")
