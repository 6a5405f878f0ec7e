"""Fits the no-load torque of a linkage, and writes its file, its report and its plot (6.3)."""

from pathlib import Path

import numpy as np

from hilplant.atomic_write import make_folder
from hilplant.bench import load_bench
from hilplant.plots.training import plot_shape
from hilplant.reports.page import TrainingReport, markdown_table, write_page
from hilplant.train import no_load
from hilplant.train.writing import write_file

_POLYNOMIAL_NOTE = (
    "(6.1) and (6.2) are functions of the sine of the angle, which is the same before and after the middle of a wipe. "
    "The torque of inertia has opposite signs there, so they cannot follow it; what they follow is the damping."
)


def train_polynomial(bench_name: str, out: Path) -> TrainingReport:
    """Fit (6.1)-(6.3) to a bench's linkage and write `polynomial.yaml`, `report.md` and a plot."""
    bench, folder = load_bench(bench_name), make_folder(out)
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
    errors = {f"random_speeds_{key}": value for key, value in unseen.items()}
    figures = {"c1": fitted.c1, "c2": fitted.c2, **content["errors"], **errors}
    return TrainingReport([*lines, table, f"{path} and {page} written"], figures)
