"""Runs the study of the controllers, or the search for their gains, prints it and draws it."""

from pathlib import Path
from typing import Any

import typer

from hilplant.cli.report import print_report
from hilplant.runtime.clock import WallClock
from hilplant.thesis.control_report import figures, found_report, report
from hilplant.thesis.control_search import search_all
from hilplant.thesis.control_study import draw, run_study, study_bench
from hilplant.units import SECOND_NS


def control_figures(name: str, out: Path | None, search: bool) -> dict[str, Any]:
    """Print the study of a bench and return its figures; with `out` its pictures are drawn into that folder."""
    clock, bench = WallClock(), study_bench(name)
    if search:
        found = search_all(bench)
        print_report(found_report(found))
        return {f"{one.rule}_{one.aim}_cost": one.cost for one in found}
    began_ns = clock.now_ns()
    study = run_study(bench)
    pictures = draw(study, bench, out) if out is not None else []
    seconds = (clock.now_ns() - began_ns) / SECOND_NS
    print_report(report(study, seconds))
    if out is not None:
        typer.echo(f"{out}: {', '.join(pictures)}")
    return figures(study, seconds)
