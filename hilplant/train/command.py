"""The commands `hilplant train tables | polynomial | torque`: train, write file and report, say what came out."""

import time
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from hilplant.bench import Bench, load_bench
from hilplant.bench.load_files import TorqueFile
from hilplant.bench.plant_description import NetworkLoad
from hilplant.models.load import LOADS
from hilplant.models.records import MODEL_AT, pack
from hilplant.train import kinematic_tables, no_load
from hilplant.train.report import folder_of, markdown_table, plot_errors, plot_shape, plot_study, write_page
from hilplant.train.torque import Data, Plan, Trained, data_of, train
from hilplant.train.torque_data import Speeds
from hilplant.train.torque_file import Dense, content_of
from hilplant.train.torque_search import Found, Range, search
from hilplant.train.torque_study import Studied, study
from hilplant.train.torque_thesis import TABLE_6_1, TABLE_6_2
from hilplant.train.writing import write_file

Figures = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Wish:
    """What the user asked of the torque network's training."""

    neurons: int
    harmonics: int
    starts: int
    speeds_rad_s: tuple[float, ...]
    seed: int
    scenarios: int
    out: Path


def train_torque(bench_name: str, wish: Wish) -> tuple[bool, Figures]:
    """Train a torque network and write `torque.yaml`, `report.md` and plots; say whether it kept its bounds."""
    console, bench, folder = Console(stderr=True), load_bench(bench_name), folder_of(wish.out)
    plan = Plan(
        neurons=wish.neurons, harmonics=wish.harmonics, starts=wish.starts, seed=wish.seed,
        speeds=Speeds(wish.speeds_rad_s),
    )  # fmt: skip
    data, begin, worked = data_of(bench, plan), time.perf_counter(), time.process_time()
    trained = _with_bar(console, data, plan)
    seconds = time.perf_counter() - begin, time.process_time() - worked
    content, dense = content_of(bench, data, trained, _command(bench_name, wish))
    path = folder / "torque.yaml"
    write_file(path, content)
    tried = _with_network(bench, content)
    bounds = (content["bounds"]["dry_n_m"], content["bounds"]["wet_n_m"])
    with _bar(console) as progress:
        task = progress.add_task("random scenarios", total=wish.scenarios, judged="")
        extent = Range(wish.scenarios, _SCENARIO_S, wish.seed)
        found = search(tried, bounds, extent, lambda done: progress.update(task, completed=done))
    figures = _torque_figures(content, trained, found, seconds)
    plot_errors(dense, folder / "torque_errors.png")
    page = write_page(folder, f"Torque network of the bench {bench.name}", _torque_sections(content, figures, dense))
    for line in _torque_lines(figures):
        print(line)
    print(f"{path} and {page} written" + (", interrupted: the best so far" if trained.interrupted else ""))
    return found.beyond_bound == 0, figures


def study_torque(bench_name: str, wish: Wish, most_neurons: int) -> Figures:
    """Print Table 6-1 beside ours, for the inputs of the source and for those of `wish`, and draw Figure 6-7."""
    console, bench, folder = Console(stderr=True), load_bench(bench_name), folder_of(wish.out)
    studied: list[Studied] = []
    kinds = sorted({0, wish.harmonics})
    data = data_of(bench, Plan(speeds=Speeds(wish.speeds_rad_s)))
    with _bar(console) as progress:
        task = progress.add_task("trainings", total=len(kinds) * most_neurons * 3, judged="")
        for harmonics in kinds:
            plan = Plan(harmonics=harmonics, seed=wish.seed, speeds=Speeds(wish.speeds_rad_s))
            sizes = range(1, most_neurons + 1)
            for one in study(data, plan, sizes, lambda neurons, number: progress.advance(task)):
                studied.append(one)
    head = ["neurons", "inputs", "total MSE", "validation MSE", "time s", "thesis total", "thesis validation", "time s"]
    rows = [_study_row(one) for one in studied]
    for row in [head, *rows]:
        print("  ".join(f"{cell:>12.4f}" if isinstance(cell, float) else f"{cell!s:>12}" for cell in row))
    plot_study(studied, folder / "neurons.png")
    page = write_page(folder, "Neurons of the torque network", [
        _VARIANCE.format(data.training.torques.var(axis=0).mean(), data.validation.torques.var(axis=0).mean()),
        markdown_table(head, rows), "![errors over neurons](neurons.png)",
    ])  # fmt: skip
    print(f"{page} written")
    figures: Figures = {}
    for one in studied:
        prefix = f"neurons_{one.neurons}_harmonics_{one.harmonics}"
        kept = {key: value for key, value in asdict(one).items() if key not in ("neurons", "harmonics")}
        figures |= {f"{prefix}_{key}": value for key, value in kept.items()}
    return figures


def train_polynomial(bench_name: str, out: Path) -> Figures:
    """Fit (6.1)-(6.3) to a bench's linkage and write `polynomial.yaml`, `report.md` and a plot."""
    bench, folder = load_bench(bench_name), folder_of(out)
    wiper = bench.plant.mechanics.wiper
    shape = no_load.no_load_shape(wiper)
    fitted = no_load.fit(shape)
    content = no_load.content_of(bench, shape, fitted)
    path = folder / "polynomial.yaml"
    write_file(path, content)
    random = np.random.default_rng(1)
    unseen = no_load.errors(shape, fitted, random.uniform(1.0, 7.0, 200).tolist())
    rows = [[key, content["errors"][key], unseen[key]] for key in unseen]
    plot_shape(shape, fitted, folder / "polynomial.png")
    lines = [
        f"c1 = {fitted.c1:.6g}, c2 = {fitted.c2:.6g} (thesis 0.0035, 0.2738)",
        f"cost (6.5) {content['errors']['cost_n_m']:.4g} N m",
        f"damping of each pivot {wiper.pivot_damping_n_m_s:g} N m s/rad",
    ]
    table = markdown_table(["error", "five speeds", "200 random speeds, 1 to 7 rad/s"], rows)
    page = write_page(folder, f"No-load polynomial of the bench {bench.name}", [
        "\n".join(lines), table, "![torques](polynomial.png)", _POLYNOMIAL_NOTE,
    ])  # fmt: skip
    print("\n".join([*lines, table, f"{path} and {page} written"]))
    errors = {f"random_speeds_{key}": value for key, value in unseen.items()}
    return {"c1": fitted.c1, "c2": fitted.c2, **content["errors"], **errors}


def train_tables(bench_name: str, bound: float, out: Path) -> Figures:
    """Tabulate rockers and blades within a bound, and write `tables.csv` and `report.md`."""
    bench, folder = load_bench(bench_name), folder_of(out)
    rows, errors = kinematic_tables.within(bench.plant.mechanics.wiper, bound)
    path = folder / "tables.csv"
    kinematic_tables.write_csv(rows, path)
    head = ["quantity", "position", "velocity", "acceleration", "worst at [deg]"]
    lines = [
        [one.quantity, one.position, one.velocity, one.acceleration, float(np.degrees(one.worst_angle_rad))]
        for one in errors
    ]
    table = markdown_table(head, lines)
    text = f"{len(rows) - 1} knots keep every error below {bound:g} of the largest value:"
    page = write_page(folder, f"Tables of the bench {bench.name}", [text, table])
    print("\n".join([text, table, f"{path} and {page} written"]))
    worst = {name: max(getattr(one, name) for one in errors) for name in ("position", "velocity", "acceleration")}
    return {"knots": len(rows) - 1, "bound": bound, **{f"worst_{name}_error": value for name, value in worst.items()}}


_SCENARIO_S = 6.0
_VARIANCE = "Variance of the torques: {:.4g} (N m)2 in the training data, {:.4g} in the separate validation."
_POLYNOMIAL_NOTE = (
    "(6.1) and (6.2) are functions of the sine of the angle, which is the same before and after the middle of a wipe. "
    "The torque of inertia has opposite signs there, so they cannot follow it; what they follow is the damping."
)


def _bar(console: Console) -> Progress:
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(*columns, TextColumn("{task.fields[judged]}"), console=console, transient=True)


def _with_bar(console: Console, data: Data, plan: Plan) -> Trained:
    """Train with a bar that counts the starts and shows the error of the one that runs."""
    with _bar(console) as progress:
        task = progress.add_task("torque network, starts", total=plan.starts, judged="")
        return train(data, plan, lambda start, epoch, judged: progress.update(
            task, completed=start, judged=f"epoch {epoch}, judged {judged:.2g}"
        ))  # fmt: skip


def _command(bench_name: str, wish: Wish) -> str:
    speeds = ",".join(f"{speed:g}" for speed in wish.speeds_rad_s)
    options = f"--neurons {wish.neurons} --harmonics {wish.harmonics} --starts {wish.starts} --speeds {speeds}"
    return f"hilplant train torque {Path(bench_name).stem} {options} --seed {wish.seed}"


def _with_network(bench: Bench, content: Figures) -> Bench:
    """Return the bench with the network that was just trained in place of its load."""
    file = TorqueFile.model_validate(content | {"content_hash": "not written yet"})
    parameters = bench.parameters._replace(networks=file.numbers())
    row = pack(parameters)
    row[MODEL_AT] = LOADS.index("network")
    load = NetworkLoad(model="network", file="torque.yaml")
    return replace(
        bench, parameters=parameters, parameter_row=row, plant=replace(bench.plant, parameters=parameters, load=load)
    )


def _torque_figures(content: Figures, trained: Trained, found: Found, seconds: tuple[float, float]) -> Figures:
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
        f"{figures['scenario_scenarios']} random scenarios: in charge in {figures['scenario_ticks_in_charge']} of "
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
    ]


def _study_row(one: Studied) -> list[Any]:
    thesis = TABLE_6_1.get(one.neurons, (float("nan"),) * 6)
    inputs = f"harmonics {one.harmonics}" if one.harmonics else "angle"
    return [one.neurons, inputs, one.total, one.validation, one.seconds, thesis[3], thesis[4], thesis[5]]
