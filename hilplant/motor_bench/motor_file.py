"""Readings of one motor in, its parameter file out."""

from pathlib import Path
from typing import Any, NamedTuple

import yaml

from hilplant.atomic_write import write_text
from hilplant.bench.parts import MotorFile
from hilplant.checked_yaml.problems import BenchError, Problem
from hilplant.checked_yaml.reading import Reading, shown
from hilplant.failure import Failure
from hilplant.measurements.files import sha256
from hilplant.motor_bench.measured_motor import MODES, ToldMotor, Values, parameters_of
from hilplant.motor_bench.readings import AnyReadings, Readings, Windings
from hilplant.motor_bench.windings import Armature, counted, path_resistance

_BRUSH = ("resistance_ohm", "inductance_henry", "constant_v_s")


class FoundMotor(NamedTuple):
    """The parameters of a motor with their standard errors, which of them were given, and which are only typical."""

    values: Values
    given: set[str]
    typical: frozenset[str] = frozenset()
    windings: Windings | None = None

    @property
    def figures(self) -> dict[str, float]:
        """Every value and its standard error by flat names; of windings also what was counted."""
        flat: dict[str, float] = {}
        if self.windings is not None:
            armature = Armature.of(self.windings)
            flat |= {f"{mode}_coils_counted": counted(armature, mode == "fast").mean for mode in MODES}
            flat["fast_over_slow"] = flat["fast_coils_counted"] / flat["slow_coils_counted"]
            flat |= {f"{mode}_path_resistance": path_resistance(armature, mode == "fast") for mode in MODES}
            flat["fast_over_slow_resistance"] = flat["fast_path_resistance"] / flat["slow_path_resistance"]
        for name, value in self.values.items():
            flat |= {name: value.n, f"{name}_standard_error": value.s}
        return flat


def motor_from_readings(path: Path, out: Path) -> FoundMotor:
    """Write a motor file to `out` from the readings in `path`.

    Raises
    ------
    Failure
        For readings that do not make a motor; nothing is written then.

    """
    readings = _read(path)
    try:
        told = parameters_of(readings, path.parent)
    except Failure as error:
        raise Failure(f"{path}: {error}") from error
    written = _document(path, readings, told)
    MotorFile.model_validate(written)
    head = "# From readings; `identified` has their standard errors.\n"
    write_text(out, head + yaml.safe_dump(written, sort_keys=False))
    windings = readings if isinstance(readings, Windings) else None
    return FoundMotor(told.values, readings.given.model_fields_set, told.typical, windings)


def _read(path: Path) -> Readings:
    reading = Reading()
    document = reading.named_file(path)
    if not reading.problems and not isinstance(document.data, dict):
        raise BenchError([Problem(shown(path), 1, "must be a group of keys; see docs/identification.md")])
    found = reading.check(document, (), {"readings": document.data}, AnyReadings) if document.data else None
    reading.raise_problems()
    if found is None:
        raise BenchError([Problem(shown(path), 1, "holds nothing; see docs/identification.md")])
    return found.readings


def _document(path: Path, readings: Readings, told: ToldMotor) -> dict[str, Any]:
    """Return the motor file; what is given or typical, and so was not measured, is listed as assumed."""
    given, values = readings.given.model_fields_set, told.values
    brushes = {}
    for mode in MODES:
        brush: dict[str, Any] = {part: values[f"{mode}_{part}"].n for part in _BRUSH}
        assumed = [part for part in _BRUSH if f"{mode}_{part}" in given | told.typical]
        brushes[mode] = brush | ({"assumed": assumed} if assumed else {})
    rest = {name: value.n for name, value in values.items() if not name.startswith(MODES)}
    assumed = [name for name in rest if name in given | told.typical]
    facts = {
        "readings": path.name,
        "sha256": sha256(path),
        "standard_errors": {name: value.s for name, value in values.items() if name not in given},
    }
    head = {"name": readings.name, "source": readings.source, "status": readings.status}
    numbers = {**brushes, "gear_ratio": readings.gear_ratio, **rest}
    return head | numbers | ({"assumed": assumed} if assumed else {}) | {"identified": facts}
