"""Table 6-1 and Figure 6-7 again: torque networks of 1 to 20 neurons, with a report."""

from dataclasses import asdict
from typing import Any

from hilplant.atomic_write import make_folder
from hilplant.bench import load_bench
from hilplant.plots.training import plot_study
from hilplant.progress import OnProgress, unseen
from hilplant.reports.page import TrainingReport, markdown_table, write_page
from hilplant.reports.torque import TorqueOptions
from hilplant.train.torque import TrainingPlan, data_of
from hilplant.train.torque_data import Speeds
from hilplant.train.torque_study import Studied, study
from hilplant.train.torque_thesis import TABLE_6_1

Figures = dict[str, Any]
_VARIANCE = "Variance of the torques: {:.4g} (N m)2 in the training data, {:.4g} in the separate validation."


def study_torque(
    bench_name: str, options: TorqueOptions, most_neurons: int, on_progress: OnProgress = unseen
) -> TrainingReport:
    """Put Table 6-1 beside ours, for the inputs of the thesis and for those of `options`, and draw Figure 6-7."""
    bench, folder = load_bench(bench_name), make_folder(options.out)
    studied: list[Studied] = []
    kinds = sorted({0, options.harmonics})
    data = data_of(bench, TrainingPlan(speeds=Speeds(options.speeds_rad_s)))
    for harmonics in kinds:
        plan = TrainingPlan(harmonics=harmonics, seed=options.seed, speeds=Speeds(options.speeds_rad_s))
        studied += study(data, plan, range(1, most_neurons + 1), on_progress)
    head = ["neurons", "inputs", "total MSE", "validation MSE", "time s", "thesis total", "thesis validation", "time s"]
    rows = [_study_row(one) for one in studied]
    lines = [
        "  ".join(f"{cell:>12.4f}" if isinstance(cell, float) else f"{cell!s:>12}" for cell in row)
        for row in [head, *rows]
    ]
    plot_study(studied, folder / "neurons.png")
    page = write_page(folder, "Neurons of the torque network", [
        _VARIANCE.format(data.training.torques.var(axis=0).mean(), data.validation.torques.var(axis=0).mean()),
        markdown_table(head, rows), "![errors over neurons](neurons.png)",
    ])  # fmt: skip
    figures: Figures = {}
    for one in studied:
        prefix = f"neurons_{one.neurons}_harmonics_{one.harmonics}"
        kept = {key: value for key, value in asdict(one).items() if key not in ("neurons", "harmonics")}
        figures |= {f"{prefix}_{key}": value for key, value in kept.items()}
    return TrainingReport([*lines, f"{page} written"], figures)


def _study_row(one: Studied) -> list[Any]:
    thesis = TABLE_6_1.get(one.neurons, (float("nan"),) * 6)
    inputs = f"harmonics {one.harmonics}" if one.harmonics else "angle"
    return [one.neurons, inputs, one.total, one.validation, one.seconds, thesis[3], thesis[4], thesis[5]]
