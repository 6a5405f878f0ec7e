"""From readings to the parameters of a motor, each with its standard error, section 5.4."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from uncertainties import UFloat

from hilplant.failure import Failure
from hilplant.motor_bench.bench_measurements import (
    MotorFriction,
    SteadyRun,
    back_emf_constant,
    bounded_friction,
    cylinder_inertia,
    decay,
    inductance,
    mean_of,
    quantity,
    resistance,
    run_down,
)
from hilplant.motor_bench.data_sheet import SpeedSheet, from_sheet, with_error
from hilplant.motor_bench.readings import BenchMode, BenchReadings, DataSheet, Given, Readings, SheetMode, Windings
from hilplant.motor_bench.sampled_quantity import fitted
from hilplant.motor_bench.typical import LEADS_TO, typical_motor
from hilplant.motor_bench.windings import brush_constants_v_s
from hilplant.units import RAD_PER_S_PER_RPM

MODES = ("slow", "fast")

#: Parameters by the names of `identify.parameters`, with standard errors.
Values = dict[str, UFloat]


class ToldMotor(NamedTuple):
    """Every parameter, and which of them rest on a typical value because the readings do not tell them."""

    values: Values
    typical: frozenset[str] = frozenset()


def parameters_of(readings: Readings, beside: Path) -> ToldMotor:
    """Return every parameter; files of samples are named from the folder `beside`.

    Raises
    ------
    Failure
        For all that nothing tells, with what would, and for readings that contradict each other.

    """
    typical = _typical(readings)
    values = _told(readings, beside, typical)
    for name, value in readings.given.model_dump(exclude_none=True).items():
        if name in values and name != "damping_n_m_s":
            raise Failure(f"{name} is given, and the readings tell it too: leave one out")
        values[name] = quantity(value)
    values |= {name: value for name, value in typical.items() if name not in values and name not in LEADS_TO}
    resting = {target for name in typical for target in LEADS_TO.get(name, (name,))}
    return ToldMotor(values, frozenset(resting - readings.given.model_fields_set))


def _typical(readings: Readings) -> Values:
    """Return typical values for what the readings do not tell."""
    lacking, offered = _lacking(readings), typical_motor()
    typical = {name: offered.values[name] for name in lacking}
    if lacking and readings.assume is None:
        told = "; ".join(f"nothing tells {name}: give {remedy}" for name, remedy in lacking.items())
        values = ", ".join(f"{name} {value.n:g} +- {value.s:g}" for name, value in typical.items())
        raise Failure(f"{told}; or `assume: typical` for {values}")
    lowest, highest = offered.voltage_v
    for mode in (readings.slow, readings.fast) if lacking and isinstance(readings, DataSheet) else ():
        if not lowest <= mode.voltage_v <= highest:
            text = f"typical values are those of motors for {lowest:g} to {highest:g} V, not for {mode.voltage_v:g} V"
            raise Failure(f"{text}: give {', '.join(lacking)}")
    return typical


def _lacking(readings: Readings) -> dict[str, str]:
    """Return what nothing tells, each with what would."""
    found: dict[str, str] = {}
    for name in MODES:
        mode = None if isinstance(readings, Windings) else getattr(readings, name)
        if isinstance(mode, SheetMode):
            if mode.stall_current_a is None and mode.resistance_ohm is None:
                found[f"{name}_resistance_ohm"] = f"stall_current_a or resistance_ohm under {name}"
            if mode.no_load_current_a is None:
                found[f"{name}_no_load_current_a"] = f"no_load_current_a under {name}"
        if isinstance(mode, BenchMode) and mode.resistance_ohm is None and not mode.blocked:
            found[f"{name}_resistance_ohm"] = f"resistance_ohm or blocked under {name}"
        if not (isinstance(mode, BenchMode) and (mode.decay or mode.time_constant_s)):
            found[f"{name}_inductance_henry"] = f"time_constant_s or decay under {name}, or it under given"
    if not (isinstance(readings, BenchReadings) and (readings.armature or readings.run_down)):
        found["inertia_kg_m2"] = "run_down or armature, or it under given"
    if readings.gear_ratio is None:
        found["gear_ratio"] = "it"
    given = readings.given.model_dump(exclude_none=True)
    return {name: remedy for name, remedy in found.items() if name not in given}


def _told(readings: Readings, beside: Path, typical: Values) -> Values:
    if isinstance(readings, BenchReadings):
        return _of_bench(readings, beside, typical)
    return _of_windings(readings) if isinstance(readings, Windings) else _of_sheet(readings, typical)


def _of_windings(windings: Windings) -> Values:
    values = {
        f"{mode}_constant_v_s": quantity(constant)
        for mode, constant in zip(MODES, brush_constants_v_s(windings), strict=True)
    }
    _refuse_impossible(values)
    return values


def _refuse_impossible(values: Values) -> None:
    """Refuse what no motor has; each text says what to look at."""
    for name, value in values.items():
        if name in ("damping_n_m_s", "coulomb_torque_n_m"):
            if value.n < 0.0:
                text = "take no-load points farther apart, or give damping_n_m_s"
                raise Failure(f"{name} comes out below 0, {value:.2uP}: {text}")
        elif not value.n > 0.0:
            raise Failure(f"{name} comes out as {value:.2uP}, not above 0: check voltages, currents and speeds")


def _of_bench(readings: BenchReadings, beside: Path, typical: Values) -> Values:
    values: Values = {}
    runs: list[SteadyRun] = []
    constants: list[UFloat] = []
    for name, mode in zip(MODES, (readings.slow, readings.fast), strict=True):
        ohm = _resistance(mode, readings.reading_error, typical.get(f"{name}_resistance_ohm"))
        points = [SteadyRun(*(with_error(each, readings.reading_error) for each in row)) for row in mode.no_load]
        constant = mean_of([back_emf_constant(point, ohm) for point in points])
        runs, constants = runs + points, constants + [constant] * len(points)
        values |= {f"{name}_resistance_ohm": ohm, f"{name}_constant_v_s": constant}
        values |= _inductance(name, mode, ohm, beside)
    friction = _friction(runs, constants, readings.given)
    values |= {"damping_n_m_s": quantity(friction[0]), "coulomb_torque_n_m": quantity(friction[1])}
    _refuse_impossible(values)  # a run-down is read with this friction
    if readings.armature is not None:
        values["inertia_kg_m2"] = cylinder_inertia(readings.armature.mass_kg, readings.armature.radius_m)
    if readings.run_down is not None:
        law = partial(run_down, friction=friction)
        values["inertia_kg_m2"] = fitted(beside / readings.run_down, "speed", law)
    return values


def _resistance(mode: BenchMode, error: float, typical: UFloat | None) -> UFloat:
    if mode.resistance_ohm is not None:
        return with_error(mode.resistance_ohm, error)
    if typical is not None:
        return typical
    return resistance([(with_error(volts, error), with_error(amperes, error)) for volts, amperes in mode.blocked])


def _inductance(name: str, mode: BenchMode, ohm: UFloat, beside: Path) -> Values:
    if mode.decay is not None:
        time_constant_s = fitted(beside / mode.decay, "current", lambda time_s, values: decay(time_s, values)[0])
        return {f"{name}_inductance_henry": inductance(time_constant_s, ohm)}
    if mode.time_constant_s is not None:
        return {f"{name}_inductance_henry": inductance(mode.time_constant_s, ohm)}
    return {}


def _friction(runs: Sequence[SteadyRun], constants: Sequence[UFloat], given: Given) -> MotorFriction:
    if given.damping_n_m_s is None:
        return bounded_friction(runs, constants)
    dry = [k * run.current_a - given.damping_n_m_s * run.speed_rad_s for run, k in zip(runs, constants, strict=True)]
    return MotorFriction(quantity(given.damping_n_m_s), mean_of(dry))


def _of_sheet(sheet: DataSheet, typical: Values) -> Values:
    slow, fast = (
        _speed(mode, sheet.tolerance, {part: typical.get(f"{name}_{part}") for part in _TYPICAL_OF_SPEED})
        for name, mode in zip(MODES, (sheet.slow, sheet.fast), strict=True)
    )
    gear_ratio = typical["gear_ratio"] if sheet.gear_ratio is None else sheet.gear_ratio
    found = from_sheet(slow, fast, gear_ratio)
    values = {name: getattr(found, name) for name in found._fields if name.endswith(("_ohm", "_v_s"))}
    runs = [
        SteadyRun(each.voltage_v, each.no_load_current_a, each.no_load_speed_rad_s * gear_ratio)
        for each in (slow, fast)
    ]
    friction = _friction(runs, [found.slow_constant_v_s, found.fast_constant_v_s], sheet.given)
    values |= {name: quantity(value) for name, value in friction._asdict().items()}
    _refuse_impossible(values)
    if found.gear_efficiency is not None:  # above 1 only within the sheet's tolerance
        values["gear_efficiency"] = quantity(min(1.0, found.gear_efficiency.n), found.gear_efficiency.s)
    return values


#: What a typical motor has to say of one speed.
_TYPICAL_OF_SPEED = ("no_load_current_a", "resistance_ohm")


def _speed(mode: SheetMode, tolerance: float, typical: Mapping[str, UFloat | None]) -> SpeedSheet:
    """Return one speed; a number within +-tolerance, evenly, has a standard error of that over the root of 3."""
    relative = tolerance / np.sqrt(3.0)
    given = {name: with_error(value, relative) for name, value in mode.model_dump(exclude_none=True).items()}
    given |= {name: value for name, value in typical.items() if value is not None}
    given["no_load_speed_rad_s"] = given.pop("no_load_rpm") * RAD_PER_S_PER_RPM
    if "resistance_ohm" in given:
        given["stall_current_a"] = given["voltage_v"] / given.pop("resistance_ohm")
    return SpeedSheet(**given)
