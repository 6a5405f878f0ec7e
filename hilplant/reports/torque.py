"""Trains the torque network of a bench, and writes its file, its report and its plots (section 6.4.2)."""

import time
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from hilplant.atomic_write import make_folder
from hilplant.bench import Bench, load_bench
from hilplant.bench.load_files import TorqueFile
from hilplant.bench.plant_description import NetworkLoad
from hilplant.models.load import LOADS
from hilplant.models.records import PARAMETER_INDEX
from hilplant.models.row import pack
from hilplant.plots.training import plot_errors
from hilplant.plots.training_data import plot_torque_fit
from hilplant.progress import OnProgress, unseen
from hilplant.reports.page import TrainingReport, markdown_table, write_page
from hilplant.train.own_data import own_torque
from hilplant.train.torque import Data, TrainedTorque, TrainingPlan, data_of, train
from hilplant.train.torque_data import Speeds
from hilplant.train.torque_file import Dense, content_of
from hilplant.train.torque_search import Range, TorqueDifferences, search
from hilplant.train.torque_thesis import TABLE_6_2
from hilplant.train.writing import write_file

Figures = dict[str, Any]
#: How long each random scenario is [s].
_SCENARIO_S = 6.0


@dataclass(frozen=True, slots=True)
class TorqueOptions:
    """What is asked of the torque network's training: `speeds_rad_s` of the wipes, and `out`, the folder.

    `data` is a table of the user's own, `validation` another one to judge by; the bench then only says what the network
    stands in for.
    """

    neurons: int
    harmonics: int
    starts: int
    speeds_rad_s: tuple[float, ...]
    seed: int
    scenarios: int
    out: Path
    data: Path | None = None
    validation: Path | None = None


def train_torque(bench_name: str, options: TorqueOptions, on_progress: OnProgress = unseen) -> TrainingReport:
    """Train a torque network and write `torque.yaml`, `report.md` and plots; it kept its bounds or not."""
    bench, folder = load_bench(bench_name), make_folder(options.out)
    plan, data = plan_and_data(bench, options)
    begin, worked = time.perf_counter(), time.process_time()
    trained = train(data, plan, on_progress)
    seconds = time.perf_counter() - begin, time.process_time() - worked
    content, dense = content_of(bench, data, trained, _command(bench_name, options))
    path = folder / "torque.yaml"
    write_file(path, content)
    tried = _with_network(bench, content)
    bounds = (content["bounds"]["dry_n_m"], content["bounds"]["wet_n_m"])
    extent = Range(options.scenarios, _SCENARIO_S, options.seed)
    found = search(tried, bounds, extent, on_progress)
    figures = _torque_figures(content, trained, found, seconds)
    plot_errors(dense, folder / "torque_errors.png")
    plot_torque_fit(data, trained, folder)
    page = write_page(folder, f"Torque network of the bench {bench.name}", _torque_sections(content, figures, dense))
    written = f"{path} and {page} written" + (", interrupted: the best so far" if trained.interrupted else "")
    return TrainingReport([*_torque_lines(figures), written], figures, found.beyond_bound == 0)


def plan_and_data(bench: Bench, options: TorqueOptions) -> tuple[TrainingPlan, Data]:
    """Return what to train and from what: the bench's own plant, or the user's table."""
    plan = TrainingPlan(
        neurons=options.neurons, harmonics=options.harmonics, starts=options.starts, seed=options.seed,
        speeds=Speeds(options.speeds_rad_s),
    )  # fmt: skip
    if options.data is None:
        return plan, data_of(bench, plan)
    own = own_torque(options.data, options.validation, options.seed)
    return replace(plan, speeds=Speeds(own.speeds_rad_s), points=len(own.data.training.states)), own.data


def _command(bench_name: str, options: TorqueOptions) -> str:
    speeds = ",".join(f"{speed:g}" for speed in options.speeds_rad_s)
    words = f"--neurons {options.neurons} --harmonics {options.harmonics} --starts {options.starts} --speeds {speeds}"
    own = f" --data {options.data.name}" if options.data is not None else ""
    return f"hilplant train torque {Path(bench_name).stem} {words} --seed {options.seed}{own}"


def _with_network(bench: Bench, content: Figures) -> Bench:
    """Return the bench with the network that was just trained in place of its load."""
    file = TorqueFile.model_validate(content | {"content_hash": "not written yet"})
    parameters = bench.parameters._replace(networks=file.numbers())
    row = pack(parameters)
    row[PARAMETER_INDEX["load.model"]] = LOADS.index("network")
    load = NetworkLoad(model="network", file=file)
    return replace(
        bench, parameters=parameters, parameter_row=row, plant=replace(bench.plant, parameters=parameters, load=load)
    )


def _torque_figures(
    content: Figures, trained: TrainedTorque, found: TorqueDifferences, seconds: tuple[float, float]
) -> Figures:
    searched = {
        f"scenario_{field.name}": getattr(found, field.name)
        for field in fields(found)
        if field.name not in ("where", "sum_n_m", "sum_squared", "current_squared")
    }
    if found.where:
        names = ("scenario", "tick", "angle_rad", "speed_rad_s", "wetness")
        searched |= {f"scenario_worst_at_{name}": value for name, value in zip(names, found.where, strict=True)}
    means = {name: getattr(found, name) for name in ("mean_n_m", "rms_n_m", "current_rms_a")}
    return {
        "neurons": trained.plan.neurons,
        "training_s": seconds[0],
        "training_processor_s": seconds[1],
        "interrupted": trained.interrupted,
        **content["errors"],
        "bound_dry_n_m": content["bounds"]["dry_n_m"],
        "bound_wet_n_m": content["bounds"]["wet_n_m"],
        **searched,
        **{f"scenario_{name}": value for name, value in means.items()},
    }


def _torque_lines(figures: Figures) -> list[str]:
    total, validation, seconds = TABLE_6_2
    return [
        f"{figures['neurons']} neurons, trained in {figures['training_s']:.1f} s, of the processor "
        f"{figures['training_processor_s']:.1f} s (thesis, 10 neurons: {seconds:g} s)",
        f"training MSE {figures['total_mse']:.4f} (N m)2 (thesis {total}), variance {figures['total_variance']:.2f}, "
        f"explained {100.0 * figures['total_share_explained']:.3f} %",
        f"separate validation MSE {figures['validation_mse']:.4f} (N m)2 (thesis {validation}), "
        f"variance {figures['validation_variance']:.2f}, "
        f"explained {100.0 * figures['validation_share_explained']:.3f} %",
        f"promised bounds: dry {figures['bound_dry_n_m']:g} N m, wet {figures['bound_wet_n_m']:g} N m",
        f"{figures['scenario_scenarios']} random scenarios: active in {figures['scenario_ticks_in_charge']} of "
        f"{figures['scenario_ticks']} ticks, beyond its bound in {figures['scenario_beyond_bound']}, "
        f"worst {figures['scenario_worst_n_m']:.3f} N m, RMS {figures['scenario_rms_n_m']:.3f} N m",
        f"against the physical plant: current RMS {figures['scenario_current_rms_a']:.3f} A of "
        f"{figures['scenario_current_range_a']:.1f} A, park closings {figures['scenario_park_stops']}, "
        f"of them in one run only {figures['scenario_park_stops_differing']}",
    ]


def _torque_sections(content: Figures, figures: Figures, dense: Dense) -> list[str]:
    worst = [int(np.abs(dense.errors[:, column]).argmax()) for column in range(2)]
    grid = [
        [name, *(content["errors"][f"grid_{name}_{kind}_n_m"] for kind in ("mean_abs", "rms", "worst")),
         float(np.degrees(dense.states[at, 0])), float(dense.states[at, 1])]
        for name, at in zip(("dry", "wet"), worst, strict=True)
    ]  # fmt: skip
    return [
        "\n".join(f"- {line}" for line in _torque_lines(figures)),
        f"Error against the physical load over a grid of {len(dense.states)} angles and speeds [N m]:",
        markdown_table(["screen", "mean", "RMS", "worst", "at angle [deg]", "at speed [rad/s]"], grid),
        "![torques and errors](torque_errors.png)",
        "![training data, Figures 6-9 and 6-10](torque_training.png)",
        "![separate validation, Figures 6-11 and 6-12](torque_validation.png)",
    ]
