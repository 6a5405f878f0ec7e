"""A user's own data in place of a bench's plant: tables for the torque network and the motor network, section 8.3.7."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench
from hilplant.failure import Failure
from hilplant.recording.read_tables import read_table
from hilplant.train.motor_data import LEAST_RAD_S, DrivenSequence, mean_torque
from hilplant.train.torque import Data
from hilplant.train.torque_data import Wipes
from hilplant.units import TURN_RAD

#: Least rows of a table, and parts that are kept from the training when there is no table for the validation.
LEAST_ROWS, JUDGED_PART, VALIDATED_PART = 100, 0.1, 0.1
TORQUE_COLUMNS = ("crank_angle_rad", "crank_speed_rad_s", "dry_torque_n_m", "wet_torque_n_m")
MOTOR_COLUMNS = ("time_s", "terminal_v", "current_a", "crank_speed_rad_s")


class OwnTorque(NamedTuple):
    """Samples of a wiper by its user, and the range of speeds [rad/s] that they cover."""

    data: Data
    speeds_rad_s: tuple[float, float]


def own_torque(path: Path, validation: Path | None, seed: int) -> OwnTorque:
    """Read torques over angle and speed; what is judged and validated by is drawn from them, or has its own table.

    Raises
    ------
    Failure
        For a table that cannot be read, lacks a column, or has too few rows, speeds or finite numbers.

    """
    wipes = _wipes(path)
    speeds = wipes.states[:, 1]
    if not (speeds.min() > 0.0 and np.ptp(speeds) > 0.0):
        raise Failure(f"{path}: crank_speed_rad_s must be above 0 and not the same everywhere")
    order = np.random.default_rng([seed, 17]).permutation(len(speeds))
    ends = [round(JUDGED_PART * len(order)), round((JUDGED_PART + VALIDATED_PART) * len(order))]
    judged, validated, trained = (_rows(wipes, np.sort(part)) for part in np.split(order, ends))
    if validation is not None:
        trained, validated = _rows(wipes, np.sort(order[ends[0] :])), _wipes(validation)
    return OwnTorque(Data(trained, judged, validated), (float(speeds.min()), float(speeds.max())))


def _rows(wipes: Wipes, rows: np.ndarray[tuple[int], np.dtype[np.intp]]) -> Wipes:
    return Wipes(wipes.states[rows], wipes.torques[rows])


def _wipes(path: Path) -> Wipes:
    columns = _columns(path, TORQUE_COLUMNS)
    states = np.column_stack([np.remainder(columns["crank_angle_rad"], TURN_RAD), columns["crank_speed_rad_s"]])
    return Wipes(states, np.column_stack([columns["dry_torque_n_m"], columns["wet_torque_n_m"]]))


def own_sequences(bench: Bench, named: Sequence[str]) -> dict[str, DrivenSequence]:
    """Read FILE@slow and FILE@fast: what each brush's path learns from.

    Raises
    ------
    Failure
        For a name without a brush, two of one brush, and tables as in :func:`own_sequence`.

    """
    found: dict[str, DrivenSequence] = {}
    for text in named:
        name, _, brush = text.rpartition("@")
        if brush not in ("slow", "fast") or not name:
            raise Failure(f"--data {text}: write FILE@slow or FILE@fast")
        if brush in found:
            raise Failure(f"--data {text}: there are already data of the {brush} brush")
        found[brush] = own_sequence(bench, Path(name), brush)
    return found


def own_sequence(bench: Bench, path: Path, brush: str) -> DrivenSequence:
    """Read voltage, current and crank speed of one brush, a row a tick of the bench.

    The torque through the gear is the table's `torque_n_m`; without it what the balance of the bench's motor leaves,
    (3.30) and (3.31), with `crank_angle_rad` where it is there, else with the speed's own integral.

    Raises
    ------
    Failure
        For a table that cannot be read, lacks a column, has gaps, or another step than the bench's.

    """
    columns = _columns(path, MOTOR_COLUMNS)
    step_s = bench.parameters.step_s
    if np.abs(np.diff(columns["time_s"]) - step_s).max() > 0.01 * step_s:
        raise Failure(f"{path}: needs a row every {1e3 * step_s:g} ms, the step of the bench, without gaps")
    speed, voltage, current = (columns[name] for name in ("crank_speed_rad_s", "terminal_v", "current_a"))
    torque = columns.get("torque_n_m", np.zeros(0))[:-1]
    if "torque_n_m" not in columns:
        ends = bench.parameters.motor.slow if brush == "slow" else bench.parameters.motor.fast
        torque = mean_torque(voltage, current, _angle(columns, step_s), speed, (bench.parameters, ends))
    known = np.zeros(len(speed) - 1, dtype=np.bool_)
    known[1:-1] = (speed[1:-2] > LEAST_RAD_S) & (speed[2:-1] > LEAST_RAD_S)
    if np.count_nonzero(known) < LEAST_ROWS:
        raise Failure(f"{path}: turns faster than {LEAST_RAD_S:g} rad/s in fewer than {LEAST_ROWS} rows")
    return DrivenSequence(np.stack([voltage[:-1], torque], axis=1), np.stack([current, speed], axis=1)[:-1], known)


def _angle(columns: Mapping[str, Floats], step_s: float) -> Floats:
    if "crank_angle_rad" in columns:
        return np.unwrap(columns["crank_angle_rad"], period=TURN_RAD)
    speed = columns["crank_speed_rad_s"]
    turned: Floats = np.concatenate([[0.0], np.cumsum(0.5 * step_s * (speed[1:] + speed[:-1]))])
    return turned


def _columns(path: Path, wanted: Sequence[str]) -> dict[str, Floats]:
    columns = read_table(path)
    missing = [name for name in wanted if name not in columns]
    if missing:
        raise Failure(f"{path}: has no column {', '.join(missing)}; wanted are {', '.join(wanted)}")
    if len(columns[wanted[0]]) < LEAST_ROWS:
        raise Failure(f"{path}: {len(columns[wanted[0]])} rows are too few; at least {LEAST_ROWS}")
    for name in wanted:
        if not np.all(np.isfinite(columns[name])):
            row = int(np.flatnonzero(~np.isfinite(columns[name]))[0])
            raise Failure(f"{path}: {name} of row {row + 1} is no finite number")
    return columns
