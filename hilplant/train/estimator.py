"""`hilplant train estimator`: the speed network of section 7.5 as a file that a controller can name."""

from typing import Any, NamedTuple

import numpy as np

from hilplant import __version__
from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench
from hilplant.bench.speed_network_file import FORMAT, SPEED_QUANTITIES, motor_record_hash
from hilplant.failure import Failure
from hilplant.models.load import REDUCED
from hilplant.progress import OnProgress, ProgressReport, unseen
from hilplant.train.speed_estimates import Case, Error, estimator_table, network_speeds
from hilplant.train.speed_network import NEURONS, NetworkRecord, train, training_record
from hilplant.train.torque import one_thread
from hilplant.train.writing import data_hash

BRUSHES = ("slow", "fast")


class TrainedEstimator(NamedTuple):
    """Both paths, the data of each brush, the errors beside the observers', and what is written."""

    paths: tuple[Floats, Floats]
    data: dict[str, NetworkRecord]
    cases: list[Case]
    content: dict[str, Any]


def train_speed_network(bench: Bench, seed: int, command: str, on_progress: OnProgress = unseen) -> TrainedEstimator:
    """Train both paths on what a bench's plant does at 2 to 20 V, wet and dry; the same seed gives the same numbers.

    Raises
    ------
    Failure
        For a bench whose load does not know wet from dry.

    """
    if bench.parameters.load.model != REDUCED:
        raise Failure(f"{bench.path}: the estimator is trained wet and dry, which needs `load: {{model: reduced}}`")
    data: dict[str, NetworkRecord] = {}
    paths: list[Floats] = []
    for done, brush in enumerate(BRUSHES):
        on_progress(ProgressReport("speed network, brushes", done, len(BRUSHES), brush))
        data[brush] = training_record(bench, brush == "fast")
        with one_thread():
            paths.append(train(data[brush], NEURONS[brush], seed))
    both = paths[0], paths[1]
    on_progress(ProgressReport("errors beside the observers'", 0, 1))
    cases = estimator_table(bench, both)
    content = {
        "format": FORMAT,
        "bench": bench.name,
        "command": command,
        "version": __version__,
        "parameter_hash": motor_record_hash(bench.parameters.motor),
        "data_hash": data_hash(*(array for each in data.values() for array in each)),
        "motor": bench.plant.motor.name,
        "step_s": bench.parameters.step_s,
        "seed": seed,
        **{brush: _section(path, data[brush]) for brush, path in zip(BRUSHES, both, strict=True)},
    }
    return TrainedEstimator(both, data, cases, content)


def training_error(path: Floats, data: NetworkRecord) -> Error:
    """Return the error of a path on the data it was trained with."""
    difference = network_speeds(data, path) - data.speed_rad_s
    return Error(float(np.sqrt(np.mean(difference**2))), float(np.abs(difference).max()), float(difference.mean()))


def _section(path: Floats, data: NetworkRecord) -> dict[str, Any]:
    limits = {
        name: [float(middle - half), float(middle + half)]
        for name, (middle, half) in zip(SPEED_QUANTITIES, path[:3, :2], strict=True)
    }
    found = training_error(path, data)
    return {
        "range": limits,
        "hidden": path[3:, :3].tolist(),
        "output": path[3:, 3].tolist(),
        "output_bias": float(path[0, 3]),
        "errors": {"rms_rad_s": found.rms_rad_s, "worst_rad_s": found.worst_rad_s},
    }
