"""Tabulates the kinematics of a bench within a bound, and writes its file and its report (6.2)."""

from pathlib import Path

import numpy as np

from hilplant.atomic_write import make_folder
from hilplant.bench import load_bench
from hilplant.reports.page import TrainingReport, markdown_table, write_page
from hilplant.train import kinematic_tables


def train_tables(bench_name: str, bound: float, out: Path) -> TrainingReport:
    """Tabulate rockers and blades within a bound, and write `tables.csv` and `report.md`."""
    bench, folder = load_bench(bench_name), make_folder(out)
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
    worst = {name: max(getattr(one, name) for one in errors) for name in ("position", "velocity", "acceleration")}
    figures = {
        "knots": len(rows) - 1,
        "bound": bound,
        **{f"worst_{name}_error": value for name, value in worst.items()},
    }
    return TrainingReport([text, table, f"{path} and {page} written"], figures)
