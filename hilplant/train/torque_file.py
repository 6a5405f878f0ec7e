"""A trained torque network as a file: weights, scale, what it was trained for, how good it is, where it may be used."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hilplant import __version__
from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench
from hilplant.bench.load_files import TORQUE_FORMAT, TorqueFile
from hilplant.bench.parameter_hash import load_hash
from hilplant.bench.plant_description import WholeWiper
from hilplant.failure import Failure
from hilplant.models import torque_samples as samples
from hilplant.train.torque import Data, TrainedTorque
from hilplant.train.torque_data import grid, physical_torques
from hilplant.train.writing import data_hash

#: Angles and speeds of the dense grid, and how much more than the largest error on it is promised.
DENSE_ANGLES, DENSE_SPEEDS = 2048, 241
ALLOWANCE = 1.05


@dataclass(frozen=True, slots=True)
class Dense:
    """The dense grid [m, 2], the physical torques on it and the network's errors there [N m], [m, 2]."""

    states: Floats
    physical: Floats
    errors: Floats


def content_of(bench: Bench, data: Data, trained: TrainedTorque, command: str) -> tuple[dict[str, Any], Dense]:
    """Return what the file says, and the dense grid on which its bounds were found."""
    draft = _draft(bench, data, trained, command)
    numbers = TorqueFile.model_validate(draft | {"content_hash": "none yet"}).numbers()
    dense = on_dense_grid(bench, numbers)
    bounds = [_promised(float(np.abs(dense.errors[:, column]).max())) for column in range(2)]
    draft["errors"] |= _shares(data, trained) | {
        f"grid_{name}_{kind}_n_m": value
        for column, name in enumerate(("dry", "wet"))
        for kind, value in _sizes(dense.errors[:, column])
    }
    draft["bounds"] = dict(zip(("dry_n_m", "wet_n_m"), bounds, strict=True))
    return draft, dense


def on_dense_grid(bench: Bench, numbers: Floats) -> Dense:
    """Compare the network, as the step evaluates it, with the physical load."""
    states = grid(np.linspace(numbers[2], numbers[3], DENSE_SPEEDS).tolist(), DENSE_ANGLES)
    physical = physical_torques(bench, states)
    return Dense(states, physical, network_torques(numbers, states) - physical)


def network_torques(numbers: Floats, states: Floats) -> Floats:
    """Return the torques of a network's row at angles and speeds, as the step evaluates it, dry and wet."""
    torques = np.empty((2, len(states)))
    for row, wet in zip(torques, (False, True), strict=True):
        samples.network_torques(numbers, wet, np.ascontiguousarray(states), row)
    return np.ascontiguousarray(torques.T)


def hash_of_load(bench: Bench) -> str:
    """Return the hash of the parameters that the torque of a bench's wiper depends on."""
    plant = bench.plant
    if not isinstance(plant.load, WholeWiper) or plant.screen is None or plant.blades is None:
        raise Failure(f"{bench.path}: the load must be reduced or network, not {plant.load.model}")
    return load_hash(plant.mechanics.written, plant.screen, plant.blades, plant.load.points)


def _draft(bench: Bench, data: Data, trained: TrainedTorque, command: str) -> dict[str, Any]:
    plan, errors = trained.plan, trained.errors
    hidden, output = trained.network.parts(trained.weights)
    return {
        "format": TORQUE_FORMAT,
        "bench": bench.name,
        "command": command,
        "version": __version__,
        "parameter_hash": hash_of_load(bench),
        "data_hash": data_hash(data.training.states, data.training.torques),
        "seed": plan.seed,
        "harmonics": plan.harmonics,
        "training": {
            "speeds_rad_s": list(plan.speeds.training),
            "judging_speeds_rad_s": list(plan.speeds.judging),
            "validation_speeds_rad_s": list(plan.speeds.validation),
            "points_of_a_wipe": plan.points,
            "starts": plan.starts,
            "epochs": trained.epochs,
        },
        "scaling": {
            "speed_rad_s": trained.scale.speeds.tolist(),
            "dry_n_m": trained.scale.torques[:, 0].tolist(),
            "wet_n_m": trained.scale.torques[:, 1].tolist(),
        },
        "hidden": hidden.tolist(),
        "output": output.tolist(),
        "errors": {
            "train_mse": errors.train,
            "validate_mse": errors.validate,
            "test_mse": errors.test,
            "total_mse": errors.total,
            "validation_mse": errors.validation,
        },
        "bounds": {"dry_n_m": 1.0, "wet_n_m": 1.0},
    }


def _shares(data: Data, trained: TrainedTorque) -> dict[str, float]:
    """Return the variance of the torques and how much of it the network explains."""
    errors = trained.errors
    found: dict[str, float] = {}
    sets = (("total", data.training, errors.total), ("validation", data.validation, errors.validation))
    for name, wipes, mse in sets:
        variance = float(wipes.torques.var(axis=0).mean())
        found |= {f"{name}_variance": variance, f"{name}_share_explained": max(0.0, 1.0 - mse / variance)}
    return found


def _sizes(errors: Floats) -> Sequence[tuple[str, float]]:
    return (
        ("mean_abs", float(np.abs(errors).mean())),
        ("rms", float(np.sqrt(np.mean(errors**2)))),
        ("worst", float(np.abs(errors).max())),
    )


def _promised(worst: float) -> float:
    """Return a bound a little above the largest error, with three digits."""
    most = ALLOWANCE * worst
    digit = 10.0 ** (math.floor(math.log10(most)) - 2)
    return round(math.ceil(most / digit) * digit, 12)
