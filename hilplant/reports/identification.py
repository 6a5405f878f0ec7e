"""The report of an identification: one HTML file with its pictures inside, readable without a network."""

from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from hilplant.atomic_write import write_text
from hilplant.identify.result_files import ResultOrigin
from hilplant.identify.starting_point import StartingPoint
from hilplant.identify.three_stages import Identified
from hilplant.identify.validation import Comparison
from hilplant.plots.identification import convergence_picture, correlation_picture, run_picture


def write_report(path: Path, found: Identified, known: StartingPoint, origin: ResultOrigin, notes: list[str]) -> None:
    """Write the report; `notes` are what was said of the data and of the way.

    Raises
    ------
    Failure
        When the file cannot be written.

    """
    environment = Environment(
        loader=PackageLoader("hilplant.reports", "."), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    text = environment.get_template("identification.html.j2").render(_content(found, known, origin, notes))
    write_text(path, text)


def _content(found: Identified, known: StartingPoint, origin: ResultOrigin, notes: list[str]) -> dict[str, Any]:
    times, left = found.times, found.solution.noise
    return {
        "bench": found.task.bench.name,
        "origin": origin,
        "data": [(name, data.sha256, len(data) * data.period_s) for name, data in (*origin.fitted, *origin.held_out)],
        "rows": parameter_rows(found, known),
        "forces": found.forces,
        "untold": untold(found),
        "withheld": found.withheld,
        "notes": notes,
        "times": times,
        "rate": times.evaluations_per_s,
        "left": left,
        "cost": found.final_cost,
        "search_cost": found.outcome.cost,
        "moved_on": found.solution.moved_on,
        "runs": [_run(comparison, "fitted") for comparison in found.fitted]
        + [_run(comparison, "held out") for comparison in found.held_out],
        "held_out": bool(found.held_out),
        "convergence": convergence_picture(found.outcome),
        "correlation": correlation_picture(found),
    }


def _run(comparison: Comparison, role: str) -> dict[str, Any]:
    return {"error": comparison.error, "role": role, "picture": run_picture(comparison)}


def parameter_rows(found: Identified, known: StartingPoint) -> list[dict[str, Any]]:
    """Return the table of parameters: the bench's value, each stage's, the interval, and what the data say."""
    rows = []
    before, choice = found.task.choice.values, found.task.choice
    for index, (verdict, interval) in enumerate(zip(found.verdicts, found.intervals, strict=True)):
        rows.append(
            {
                "name": verdict.name,
                "unit": choice.parameters[index].unit,
                "previous": before[index],
                "first": known.first_stage.get(verdict.name),
                "space": (found.space.low[index], found.space.high[index]),
                "second": found.outcome.values[index],
                "value": verdict.value,
                "standard_error": verdict.standard_error,
                "interval": interval,
                "identifiable": verdict.identifiable,
            }
        )
    return rows


def untold(found: Identified) -> list[dict[str, Any]]:
    """Return the parameters that the data do not tell, what they hang together with, and what would tell them."""
    return [
        {
            "name": verdict.name,
            "together": verdict.together,
            "experiments": [each.text for each in found.advice if verdict.name in each.tells] or [""],
        }
        for verdict in found.verdicts
        if not verdict.identifiable
    ]
