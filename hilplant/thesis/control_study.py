"""`hilplant study control`: all controllers through the test of section 7.2, beside the thesis' tables."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.atomic_write import make_folder
from hilplant.bench import load_bench
from hilplant.bench.assembly import Bench
from hilplant.control.catalogue import ADAPTING, SEARCHED, controller_named, sensorless, with_stages
from hilplant.control.controller import Tables
from hilplant.control.fuzzy_sets import gain_table
from hilplant.control.records import Controller
from hilplant.failure import Failure
from hilplant.models.load import LOADS, REDUCED
from hilplant.models.row import pack
from hilplant.signals import INPUT_INDEX
from hilplant.thesis.control_rain import Duty, controlled_duty, rain, two_speed_duty
from hilplant.thesis.control_test import STATES, DriveRun, Metrics, SpeedProfile, metrics, run_drive, thesis_drive
from hilplant.thesis.control_thesis import ROWS, Order, controller_of, orders
from hilplant.train.speed_estimates import CHANGES, OFF, Case, estimated, estimator_table, full_range
from hilplant.train.speed_network import record, trained_paths
from hilplant.units import SECOND_NS

#: Our own controllers, by their name in the catalogue.
OURS = ("pid_imc", *(f"{rule}_{aim}" for rule, aim in SEARCHED), "cascade")

#: Controllers that are run without a speed sensor: name, source of the speed, part of the resistance's correction, and
#: the plant's resistance over the one that the estimator believes.
SENSORLESS = (
    ("pid", "network", 0.0, 1.0),
    ("pid", "observer", 0.0, 1.0),
    ("error_hebb_fuzzy", "network", 0.0, 1.0),
    ("error_hebb_fuzzy", "observer", 0.0, 1.0),
    ("cascade", "observer", 0.0, 1.0),
    ("cascade", "observer", 0.0, 1.2),
    ("cascade", "observer", ADAPTING, 1.2),
)


class Study(NamedTuple):
    """Everything that the study found."""

    runs: dict[str, DriveRun]
    results: dict[str, Metrics]
    orders: dict[str, Order]
    blind: dict[str, Metrics]
    paths: tuple[Floats, Floats]
    cases: list[Case]
    duties: dict[str, Duty]
    stages: DriveRun


def study_bench(name: str) -> Bench:
    """Load the bench; Failure unless its load knows wet from dry."""
    bench = load_bench(name)
    if bench.parameters.load.model != REDUCED:
        model = LOADS[int(bench.parameters.load.model)]
        raise Failure(f"{bench.path}: the study needs `load: {{model: reduced}}`, which has a wet and a dry screen; "
                      f"this one is {model}")  # fmt: skip
    return bench


def run_study(bench: Bench) -> Study:
    """Run all parts of the study."""
    motor, period_s, drive = bench.parameters.motor, bench.step_ns / SECOND_NS, thesis_drive(bench)
    made = {row.name: controller_of(row, motor, period_s) for row in ROWS}
    made |= {name: controller_named(name, motor, period_s) for name in OURS}
    runs = {name: run_drive(bench, controller, drive) for name, controller in made.items()}
    results = {name: metrics(run) for name, run in runs.items()}
    paths = trained_paths(bench)
    blind = _blind(bench, drive, paths)
    cascade = with_stages(made["cascade"], motor)
    duties = _duties(bench, cascade)
    stages = run_drive(bench, cascade, stages_drive(bench))
    return Study(runs, results, orders(results), blind, paths, estimator_table(bench, paths), duties, stages)


def _blind(bench: Bench, drive: SpeedProfile, paths: tuple[Floats, Floats]) -> dict[str, Metrics]:
    """Run the test without a speed sensor: as it is, and on a plant whose resistance is 20 % higher."""
    motor, period_s = bench.parameters.motor, bench.step_ns / SECOND_NS
    tables = Tables(gain_table(), *paths)
    results = {}
    for name, source, adapting, resistance in SENSORLESS:
        controller = sensorless(controller_named(name, motor, period_s), motor, source, adapting)
        parameters = CHANGES["resistance"](bench.parameters, resistance)
        plant = replace(bench, parameters=parameters, parameter_row=pack(parameters))
        warm = f", R {100.0 * (resistance - 1.0):+.0f} %" if resistance != 1.0 else ""
        label = f"{name} by {source}{warm}" + (", adapting" if adapting else "")
        results[label] = metrics(run_drive(plant, controller, drive, tables))
    return results


def _duties(bench: Bench, cascade: Controller) -> dict[str, Duty]:
    needs = rain()
    return {
        "two speeds": two_speed_duty(bench, needs),
        "two speeds, intermittent": two_speed_duty(bench, needs, intermittent=True),
        "cascade": controlled_duty(bench, needs, cascade),
    }


def stages_drive(bench: Bench) -> SpeedProfile:
    """Return a reference that rises beyond what the slow brush can do, and falls again, on a wet screen."""
    time_s = np.arange(round(16.0 * SECOND_NS / bench.step_ns)) * (bench.step_ns / SECOND_NS)
    reference = math.pi * np.interp(time_s, [0.0, 3.0, 7.0, 9.0, 13.0, 16.0], [0.8, 0.8, 2.2, 2.2, 0.8, 0.8])
    rows = np.tile(bench.input_row, (time_s.size, 1))
    rows[:, INPUT_INDEX["screen"]] = 1.0
    return SpeedProfile(reference, rows, 0.0)


def draw(study: Study, bench: Bench, folder: Path) -> list[str]:
    """Draw all pictures into a folder and return their names."""
    from hilplant.plots import control as plots

    make_folder(folder)
    groups = [("pid", "PID of Table 7-1, and by SIMC (compare Figure 7-3)", ["pid", "pid_imc"])]
    figures = {"hebb": ("7-6", "7-12"), "error_hebb": ("7-7", "7-13"), "quadratic": ("7-8", "7-14")}
    for rule, (fixed, fuzzy) in figures.items():
        of_rule = [row for row in ROWS if row.rule == rule]
        title = rule.replace("_", "-").title()
        names = [row.name for row in of_rule if not row.fuzzy]
        groups.append((rule, f"Single neuron, {title} rule, fixed K (compare Figure {fixed})", names))
        names = [row.name for row in of_rule if row.fuzzy]
        groups.append((f"{rule}_fuzzy", f"Single neuron, {title} rule, fuzzy K (compare Figure {fuzzy})", names))
    groups.append(("cascade", "Cascade with load observer, and the best of the thesis'", ["cascade", ROWS[-2].name]))
    dry = [(begin_s, end_s) for begin_s, end_s, _, wet in STATES if wet == 0.0]
    plots.plot_all(folder, study.runs, dry, groups)
    plots.plot_fuzzy(folder / "fuzzy_sets.png")
    plots.plot_estimates(folder / "sensorless.png", *_estimates(bench, study.paths))
    plots.plot_stages(folder / "stages.png", study.stages)
    return sorted(path.name for path in folder.glob("*.png"))


def _estimates(bench: Bench, paths: tuple[Floats, Floats]) -> tuple[Any, ...]:
    voltages, wetness = full_range(bench.parameters.step_s)
    data = record(bench, CHANGES["resistance"](bench.parameters, 1.0 + OFF), voltages, wetness, False)
    time_s = np.arange(voltages.size) * bench.parameters.step_s
    return time_s, data.speed_rad_s, estimated(bench, data, False, paths[0])
