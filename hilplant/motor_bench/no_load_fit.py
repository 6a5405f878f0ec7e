"""A motor fitted to measured no-load rows: voltage, current and speed with nothing on the shaft, section 5.4.2.

At a steady speed (3.30), (3.31) with dry friction c at the motor shaft are

    V = R i + K w        K i = b w + c

so that each row gives its own constant K = (V - R i)/w, (5.18), and the rows together give b and c, which the two
stages share. The constant of a stage is the mean over its rows; b and c are those with which the equations miss the
measured currents and speeds least, by least squares of the relative misses. Rows that do not fit their neighbours
are marked in the file and left out of both.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field
from scipy.optimize import least_squares

from hilplant import resources
from hilplant.bench.parts import MotorFile, Sourced
from hilplant.checked_yaml.checked import Checked, Positive
from hilplant.checked_yaml.reading import Description, Reading
from hilplant.models.records import Brush, Motor

STAGES = ("slow", "fast")


class NoLoadRow(Checked):
    """One measurement: a voltage at one brush, and the current and the speed of the motor shaft that it gave."""

    stage: Literal["slow", "fast"]
    supply_v: Positive
    current_a: Positive
    speed_rad_s: Positive
    left_out: str = ""


class Resistances(Checked):
    """Of the armature between each brush and the common one [ohm]."""

    slow: Positive
    fast: Positive


class NoLoadFile(Sourced):
    """Measured rows, with the resistances that were measured beside them."""

    resistance_ohm: Resistances
    rows: Annotated[list[NoLoadRow], Field(min_length=1)]

    def resistance_of(self, stage: str) -> float:
        """Return the resistance of a stage [ohm]."""
        return self.resistance_ohm.slow if stage == "slow" else self.resistance_ohm.fast

    @property
    def used(self) -> list[NoLoadRow]:
        """The rows that count."""
        return [row for row in self.rows if not row.left_out]


@dataclass(frozen=True, slots=True)
class NoLoadFit:
    """Constants of both stages [V s/rad], viscous [N m s/rad] and dry [N m] friction at the motor shaft."""

    slow_constant_v_s: float
    fast_constant_v_s: float
    damping_n_m_s: float
    coulomb_torque_n_m: float


@dataclass(frozen=True, slots=True)
class Miss:
    """By how much the equations miss a row, as a part of what was measured; positive where they give too much."""

    row: NoLoadRow
    current: float
    speed: float


def read_no_load(name: str | Path = "table_5_4") -> NoLoadFile:
    """Read measured rows from a file, or from a shipped one by its name.

    Raises
    ------
    BenchError
        With every problem, each with file and line.

    """
    return read_described(resources.named("measurements", name), NoLoadFile)


def read_motor(name: str | Path) -> Motor:
    """Read a motor from a file, or a shipped one by its name."""
    return read_described(resources.named("motors", name), MotorFile).record()


def read_described(path: Path, kind: type[Description]) -> Description:
    """Read a file of a kind.

    Raises
    ------
    BenchError
        With every problem, each with file and line.

    """
    reading = Reading()
    document = reading.named_file(path)
    found = reading.take(document, (), kind) if reading.sources and not document.problems else None
    reading.raise_problems()
    if found is None:
        raise AssertionError("a file that failed left no problem behind")
    return found


def fit_no_load(measured: NoLoadFile) -> NoLoadFit:
    """Return what fits the rows that count best."""
    constants = {stage: _mean_constant(measured, stage) for stage in STAGES}
    brushes = {stage: Brush(measured.resistance_of(stage), 0.0, constants[stage]) for stage in STAGES}

    def misses(scaled: np.ndarray) -> list[float]:
        damping, coulomb = scaled * _SCALE
        found = [_miss(row, brushes[row.stage], damping, coulomb) for row in measured.used]
        return [part for miss in found for part in (miss.current, miss.speed)]

    damping, coulomb = least_squares(misses, np.ones(2), bounds=(0.0, np.inf), xtol=1e-12, ftol=1e-12).x * _SCALE
    return NoLoadFit(constants["slow"], constants["fast"], float(damping), float(coulomb))


def misses_of(motor: Motor, rows: Sequence[NoLoadRow]) -> list[Miss]:
    """Return by how much a motor misses each row."""
    return [
        _miss(row, motor.slow if row.stage == "slow" else motor.fast, motor.damping_n_m_s, motor.coulomb_torque_n_m)
        for row in rows
    ]


def steady_state(brush: Brush, damping_n_m_s: float, coulomb_torque_n_m: float, supply_v: float) -> tuple[float, float]:
    """Return current [A] and speed [rad/s] of a motor that turns steadily with nothing on its shaft."""
    resistance, constant = brush.resistance_ohm, brush.constant_v_s
    speed = (constant * supply_v - resistance * coulomb_torque_n_m) / (resistance * damping_n_m_s + constant**2)
    return (damping_n_m_s * speed + coulomb_torque_n_m) / constant, speed


#: Sizes of damping and dry friction of a wiper motor, so that the search is as fine in both.
_SCALE = np.array([1e-4, 0.05])


def _mean_constant(measured: NoLoadFile, stage: str) -> float:
    """Return the mean of (5.18) over a stage's rows [V s/rad]."""
    resistance = measured.resistance_of(stage)
    rows = [row for row in measured.used if row.stage == stage]
    return float(np.mean([(row.supply_v - resistance * row.current_a) / row.speed_rad_s for row in rows]))


def _miss(row: NoLoadRow, brush: Brush, damping_n_m_s: float, coulomb_torque_n_m: float) -> Miss:
    current, speed = steady_state(brush, damping_n_m_s, coulomb_torque_n_m, row.supply_v)
    return Miss(row, current / row.current_a - 1.0, speed / row.speed_rad_s - 1.0)
