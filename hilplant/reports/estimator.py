"""Trains the speed network of a bench, and writes its file, its report and its plots (7.5)."""

from pathlib import Path
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.atomic_write import make_folder
from hilplant.bench import Bench, load_bench
from hilplant.plots.control import plot_estimates
from hilplant.plots.training_data import plot_training_data
from hilplant.progress import OnProgress, unseen
from hilplant.reports.page import TrainingReport, markdown_table, write_page
from hilplant.train.drawn_data import training_data
from hilplant.train.estimator import BRUSHES, TrainedEstimator, train_speed_network
from hilplant.train.speed_estimates import ESTIMATORS, estimated, full_range
from hilplant.train.speed_network import record
from hilplant.train.writing import write_file

#: The thesis shows its errors in figures alone; with the nominal motor ours are called good below this [rad/s].
GOOD_RMS_RAD_S = 0.05


def train_estimator(bench_name: str, seed: int, out: Path, on_progress: OnProgress = unseen) -> TrainingReport:
    """Train a speed network, write `estimator.yaml`, `report.md` and plots; good with the nominal motor, or not."""
    bench, folder = load_bench(bench_name), make_folder(out)
    command = f"hilplant train estimator {Path(bench_name).stem} --seed {seed}"
    trained = train_speed_network(bench, seed, command, on_progress)
    path = folder / "estimator.yaml"
    write_file(path, trained.content)
    plot_training_data(training_data("estimator", bench), folder / "estimator_data.png", "Data of the speed network")
    for index, brush in enumerate(BRUSHES):
        plot_estimates(folder / f"estimator_{brush}.png", *_drawn(bench, trained, index), brush)
    page = write_page(folder, f"Speed network of the bench {bench.name}", _sections(trained))
    lines, figures = _lines(trained), _figures(trained)
    kept = all(case.errors[ESTIMATORS[0]].rms_rad_s < GOOD_RMS_RAD_S for case in trained.cases[:2])
    return TrainingReport([*lines, f"{path} and {page} written"], figures, kept)


def _drawn(bench: Bench, trained: TrainedEstimator, index: int) -> tuple[Floats, Floats, dict[str, Floats]]:
    voltages, wetness = full_range(bench.parameters.step_s)
    data = record(bench, bench.parameters, voltages, wetness, index == 1)
    time_s: Floats = np.arange(voltages.size, dtype=np.float64) * bench.parameters.step_s
    return time_s, data.speed_rad_s, estimated(bench, data, index == 1, trained.paths[index])


def _lines(trained: TrainedEstimator) -> list[str]:
    lines = []
    for case in trained.cases[:2]:
        said = ", ".join(
            f"{name} {error.rms_rad_s:.3f} ({error.worst_rad_s:.2f})" for name, error in case.errors.items()
        )
        lines.append(f"{case.brush} brush, error of the crank speed [rad/s], rms (largest): {said}")
    return lines


def _sections(trained: TrainedEstimator) -> list[str]:
    rows = []
    for case in trained.cases:
        what = case.parameter if case.factor == 1.0 else f"{case.parameter} {100.0 * (case.factor - 1.0):+.0f} %"
        rows.append([what, case.brush, *(f"{e.rms_rad_s:.3f} ({e.worst_rad_s:.2f})" for e in case.errors.values())])
    return [
        "\n".join(f"- {line}" for line in _lines(trained)),
        "Error of the crank speed, rms (largest) [rad/s], over 3 to 20 V, wet and dry, one parameter of the plant off:",
        markdown_table(["off", "brush", *ESTIMATORS], rows),
        "![what it learned from, Figures F-8 and F-9](estimator_data.png)",
        *(f"![estimates, {brush}, Figures 7-16 and 7-17](estimator_{brush}.png)" for brush in BRUSHES),
    ]


def _figures(trained: TrainedEstimator) -> dict[str, Any]:
    figures: dict[str, Any] = {"seed": trained.content["seed"]}
    for brush in BRUSHES:
        figures |= {f"{brush}_training_{name}": value for name, value in trained.content[brush]["errors"].items()}
    for case in trained.cases[:2]:
        for name, error in case.errors.items():
            word = name.replace(", resistance ", "_")
            figures[f"{case.brush}_{word}_rms_rad_s"] = error.rms_rad_s
            figures[f"{case.brush}_{word}_worst_rad_s"] = error.worst_rad_s
    return figures
