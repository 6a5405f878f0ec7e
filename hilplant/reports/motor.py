"""Trains the motor network of a bench, and writes its file, its report and its plots (section 6.4.3)."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from hilplant.atomic_write import make_folder
from hilplant.bench import load_bench
from hilplant.plots.motor_network import plot_grid, plot_paths
from hilplant.progress import OnProgress, unseen
from hilplant.reports.page import TrainingReport, markdown_table, write_page
from hilplant.train.motor import MotorNetwork, train_motor, write_network
from hilplant.train.motor_compare import Differences, Grid, over_grid, random_runs
from hilplant.train.motor_figures import GOAL_MSE, GOAL_S, lines, path_figures, table
from hilplant.train.motor_search import OneTickErrors, search
from hilplant.train.own_data import own_sequences

Figures = dict[str, Any]
_RUNS = 100
#: Added to the seed of the scenarios that check the bounds, so that they are none of those that set them.
_OTHER_SEED = 1_000_000


class MotorOptions(NamedTuple):
    """What is asked of the motor network's training; `data` are own tables, FILE@slow or FILE@fast."""

    seed: int
    scenarios: int
    out: Path
    data: Sequence[str] = ()


def report_motor(bench_name: str, options: MotorOptions, on_progress: OnProgress = unseen) -> TrainingReport:
    """Train a motor network, write `motor.yaml`, `report.md` and plots; it kept its bounds or not."""
    seed, scenarios, out, data = options
    bench, folder = load_bench(bench_name), make_folder(out)
    command = f"hilplant train motor {Path(bench_name).stem} --seed {seed}"
    command += "".join(f" --data {Path(name).name}" for name in data)
    network = train_motor(bench, seed, command, on_progress, own_sequences(bench, data))
    write_network(network, folder / "motor.yaml")
    others = search(bench, network.networks, scenarios, seed + _OTHER_SEED)
    differences = random_runs(bench, network.networks, _RUNS, seed)
    grid = over_grid(bench, network.networks)
    plot_paths(network.paths, folder / "motor_test.png")
    plot_grid(grid, folder / "motor_grid.png")
    kept, verdict = _verdict(network, others)
    said = [*_lines(network, differences), verdict]
    page = write_page(folder, f"Motor network of the bench {bench.name}", _sections(network, said, grid))
    written = f"{folder / 'motor.yaml'} and {page} written" + (", interrupted: the best so far" * network.interrupted)
    shown = [table(list(network.paths)), *said, written]
    checked = {f"check_{name}": value for name, value in asdict(others).items() if not name.endswith("_at")}
    figures = _figures(network, differences) | checked | {"check_kept_bounds": kept}
    return TrainingReport(shown, figures, kept)


def _verdict(network: MotorNetwork, others: OneTickErrors) -> tuple[bool, str]:
    """Return whether scenarios that had no part in the bounds stay within them, and a line that says so."""
    bound = network.content["bound"]
    kept = others.current_a <= bound["current_a"] and others.crank_speed_rad_s <= bound["crank_speed_rad_s"]
    worst = f"worst {others.current_a:.3f} A, {others.crank_speed_rad_s:.4f} rad/s"
    return (
        kept,
        f"{others.scenarios} other wild scenarios: {'all within' if kept else 'NOT within'} the bounds, {worst}",
    )


def _lines(network: MotorNetwork, differences: Differences) -> list[str]:
    found, bound, last = network.found, network.content["bound"], lines(list(network.paths))[-1]
    return [
        f"closed-loop MSE {last.errors[3]:.2e} (goal {GOAL_MSE:g}, thesis 0.0068), closed-loop training "
        f"{last.seconds:.1f} s (goal {GOAL_S:g} s, thesis 7 h 19 min)",
        f"{found.scenarios} wild scenarios, active in {100.0 * found.share_in_charge:.0f} % of the ticks: one tick "
        f"of the network is at most {found.current_a:.3f} A and {found.crank_speed_rad_s:.4f} rad/s from one "
        f"of the physical motor (RMS {found.rms_current_a:.4f} A, {found.rms_crank_speed_rad_s:.5f} rad/s)",
        f"stated bounds for one tick: {bound['current_a']:g} A, {bound['crank_speed_rad_s']:g} rad/s",
        f"{differences.runs} random runs of {differences.ticks} ticks active, each plant left to itself: current "
        f"mean {differences.current_mean_a:.4f} A, RMS {differences.current_rms_a:.4f} A of a range of "
        f"{differences.current_range_a:.1f} A, worst {differences.current_worst_a:.2f} A in run "
        f"{differences.current_worst_run} at {differences.current_worst_s:.3f} s; crank speed mean "
        f"{differences.crank_speed_mean_rad_s:.5f}, RMS {differences.crank_speed_rms_rad_s:.5f}, worst "
        f"{differences.crank_speed_worst_rad_s:.3f} rad/s",
    ]


def _sections(network: MotorNetwork, said: list[str], grid: Grid) -> list[str]:
    errors = [
        [path.brush, part, *(figures[name] for name in ("ticks", "current_mse_a2", "current_explained",
         "current_worst_a", "crank_speed_mse_rad2_s2", "crank_speed_explained", "crank_speed_worst_rad_s"))]
        for path in network.paths
        for part, figures in path_figures(path).items()
    ]  # fmt: skip
    head = ["brush", "part", "ticks", "current MSE [A2]", "explained", "worst [A]", "speed MSE [(rad/s)2]", "explained",
            "worst [rad/s]"]  # fmt: skip
    worst = [[name, float(np.nanmax(values)), float(np.nanmean(values))] for name, values in grid.current_rms_a.items()]
    return [
        f"```\n{table(list(network.paths))}\n```",
        "\n".join(f"- {line}" for line in said),
        "Closed loop, ticks that the network answers for:",
        markdown_table(head, errors),
        "RMS error of the current over 3 s from rest, over supplies of 8 to 18 V and brakes up to 10 N m [A]:",
        markdown_table(["brush, screen", "worst", "mean"], worst),
        "![test part](motor_test.png)",
        "![errors over supply and brake](motor_grid.png)",
    ]


def _figures(network: MotorNetwork, differences: Differences) -> Figures:
    opened, shut, closed = lines(list(network.paths))
    names = ("train", "validate", "test", "total")
    figures: Figures = {"seed": network.content["seed"], "interrupted": network.interrupted}
    for label, line in (("open", opened), ("open_run_closed", shut), ("closed", closed)):
        figures |= {f"{label}_mse_{part}": error for part, error in zip(names, line.errors, strict=True)}
    figures |= {"open_training_s": opened.seconds, "closed_training_s": closed.seconds}
    for path in network.paths:
        figures |= {f"{path.brush}_{name}": value for name, value in path_figures(path)["total"].items()}
        figures[f"{path.brush}_epochs_open"], figures[f"{path.brush}_epochs_closed"] = path.epochs
    figures |= {f"bound_{name}": value for name, value in network.content["bound"].items()}
    figures |= {f"search_{name}": value for name, value in asdict(network.found).items() if not name.endswith("_at")}
    return figures | {f"random_{name}": value for name, value in asdict(differences).items()}
