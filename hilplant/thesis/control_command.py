"""What `hilplant study control` does."""

from pathlib import Path
from typing import Any

import typer

from hilplant.runtime.clock import WallClock
from hilplant.thesis.control_report import figures, print_found, print_study
from hilplant.thesis.control_study import draw, run_study, study_bench
from hilplant.units import SECOND_NS


def control_study(name: str, out: Path | None, search: bool) -> dict[str, Any]:
    """Run the study, or the search for gains, print it, draw it, and return its figures."""
    clock, bench = WallClock(), study_bench(name)
    if search:
        from hilplant.thesis.control_search import search_all

        found = search_all(bench)
        print_found(found)
        return {f"{one.rule}_{one.aim}_cost": one.cost for one in found}
    began_ns = clock.now_ns()
    study = run_study(bench)
    pictures = draw(study, bench, out) if out is not None else []
    seconds = (clock.now_ns() - began_ns) / SECOND_NS
    print_study(study, seconds)
    if out is not None:
        typer.echo(f"{out}: {', '.join(pictures)}")
    return figures(study, seconds)
