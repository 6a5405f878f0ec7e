"""What each network learns from, as columns that can be drawn and written: Figures F-1 to F-4, F-6 to F-9."""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench
from hilplant.failure import Failure
from hilplant.train.motor_data import LENGTH_S, recorded
from hilplant.train.speed_network import training_record
from hilplant.train.torque import TrainingPlan, data_of
from hilplant.train.torque_data import Wipes

NETWORKS = ("torque", "motor", "estimator")


class TrainingData(NamedTuple):
    """One set of data: what it is for, the figure of the thesis beside it, and its columns by name."""

    name: str
    figure: str
    columns: dict[str, Floats]


def training_data(network: str, bench: Bench, seed: int = 1) -> list[TrainingData]:
    """Return the data that `hilplant train NETWORK` makes of a bench, with the same seed.

    Raises
    ------
    Failure
        For a network that there is not, or a bench that has no such data.

    """
    if network == "torque":
        return _torque(bench)
    if network == "motor":
        return [_motor(bench, index, brush, seed) for index, brush in enumerate(("slow", "fast"))]
    if network == "estimator":
        return [_estimator(bench, brush) for brush in ("slow", "fast")]
    raise Failure(f"there is no network '{network}'; there are {', '.join(NETWORKS)}")


def _torque(bench: Bench) -> list[TrainingData]:
    data = data_of(bench, TrainingPlan())
    sets = (("training", "F-1, F-2", data.training), ("separate validation", "F-3, F-4", data.validation))
    return [TrainingData(name, figure, _wipe_columns(wipes)) for name, figure, wipes in sets]


def _wipe_columns(wipes: Wipes) -> dict[str, Floats]:
    return {
        "sample": np.arange(len(wipes.states), dtype=np.float64),
        "crank_angle_rad": wipes.states[:, 0],
        "crank_speed_rad_s": wipes.states[:, 1],
        "dry_torque_n_m": wipes.torques[:, 0],
        "wet_torque_n_m": wipes.torques[:, 1],
    }


def _motor(bench: Bench, index: int, brush: str, seed: int) -> TrainingData:
    sequence = recorded(bench, brush, LENGTH_S, np.random.default_rng([seed, index, 0]))
    names = ("terminal_v", "torque_n_m", "current_a", "crank_speed_rad_s")
    values = np.hstack([sequence.inputs, sequence.outputs])
    columns: dict[str, Floats] = {"time_s": np.arange(len(values), dtype=np.float64) * bench.parameters.step_s}
    columns |= {name: values[:, at] for at, name in enumerate(names)} | {"known": sequence.known.astype(float)}
    return TrainingData(f"{brush} brush", "F-6" if brush == "slow" else "F-7", columns)


def _estimator(bench: Bench, brush: str) -> TrainingData:
    data = training_record(bench, brush == "fast")
    columns: dict[str, Floats] = {
        "time_s": np.arange(data.voltage_v.size, dtype=np.float64) * bench.parameters.step_s,
        "terminal_v": data.voltage_v,
        "current_a": data.current_a,
        "crank_speed_rad_s": data.speed_rad_s,
    }
    return TrainingData(f"{brush} brush", "F-9" if brush == "slow" else "F-8", columns)
