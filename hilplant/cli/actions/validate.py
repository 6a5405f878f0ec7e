"""Validates a bench against recordings."""

from collections.abc import Sequence
from typing import Any

import typer

from hilplant.bench import load_bench
from hilplant.identify.run_of_data import make_run
from hilplant.identify.validation import compare
from hilplant.measurements.named_data import read_named

Bounds = tuple[float | None, float | None]


def validate_files(
    texts: Sequence[str], bench_name: str, reading: tuple[str, str | None], bounds: Bounds
) -> tuple[bool, dict[str, Any]]:
    """Print the errors of each recording; return whether all are within the bounds [A], [ms], and the figures."""
    bench = load_bench(bench_name)
    runs = [make_run(named.data, bench, named.screen) for named in read_named(texts, *reading)]
    good, figures = True, dict[str, Any]()
    for index, compared in enumerate(compare(runs, bench.parameter_row, bench.tables), 1):
        error = compared.error
        typer.echo(
            f"{error.name}: current {error.rms_current_a:.4g} A rms, {error.worst_current_a:.4g} A at worst "
            f"(noise {error.noise_a:.4g} A), park edges {1e3 * error.rms_edge_s:.4g} ms rms; "
            f"started at {error.start_rad:.4g}, offset {error.offset_a:+.3g} A"
        )
        found = (error.rms_current_a, 1e3 * error.rms_edge_s)
        for name, value, bound, unit in zip(("current", "park edges"), found, bounds, ("A", "ms"), strict=True):
            if bound is not None and value > bound:
                good = False
                typer.echo(f"{error.name}: {name}: {value:.4g} {unit} rms is above {bound:g} {unit}", err=True)
        figures |= {f"recording_{index}_{key}": value for key, value in error._asdict().items()}
    return good, figures
