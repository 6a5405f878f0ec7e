"""Identifies with its progress shown, prints what was found, and writes the report."""

from pathlib import Path
from typing import Any

import typer

from hilplant.cli.progress import progress_shown
from hilplant.identify.from_files import IdentifiedFiles, Request, figures, identify_files, partial_figures
from hilplant.identify.stages import StagedValues
from hilplant.identify.starting_point import StartingPoint
from hilplant.identify.three_stages import Identified


def run_identification(request: Request, report: Path | None) -> dict[str, Any]:
    """Identify, write and print; return the figures."""
    with progress_shown() as on_progress:
        done = identify_files(request, on_progress)
    written = done.written
    if isinstance(done.found, StagedValues):
        done.journal.remove()
        _print_partly(done, done.found)
        return partial_figures(done.task, done.found)
    if report is not None:
        from hilplant.reports.identification import write_report

        write_report(report, done.found, done.known, done.origin, done.notes)
        written = [*written, report]
    done.journal.remove()
    _print(done.found, done.known, written)
    return figures(done.found)


def _print_partly(done: IdentifiedFiles, found: StagedValues) -> None:
    for note in done.known.notes:
        typer.echo(note)
    typer.echo(f"{'parameter':24}{'before':>12}{'found':>12}   stages {', '.join(map(str, done.task.stages))}")
    choice = done.task.choice
    for name, before, value in zip(choice.names, choice.values, found.values, strict=True):
        typer.echo(f"{name:24}{before:12.5g}{value:12.5g}")
    for role, compared in (("fitted", found.fitted), ("held out", found.held_out)):
        for each in (comparison.error for comparison in compared):
            typer.echo(f"{each.name} ({role}): current {each.rms_current_a:.4g} A rms, noise {each.noise_a:.4g} A")
    typer.echo(f"cost {found.cost:.4g} in {found.seconds:.1f} s; intervals come with stage 3")
    typer.echo(f"written: {', '.join(map(str, done.written))}")


def _print(found: Identified, known: StartingPoint, written: list[Path]) -> None:
    for note in known.notes:
        typer.echo(note)
    _print_parameters(found)
    _print_errors(found)
    for hint in found.advice:
        typer.echo(f"would tell {', '.join(hint.tells)}: {hint.text}")
    times = found.times
    answered = f" ({times.journal_note})" if times.journal_note else ""
    typer.echo(
        f"search: {times.global_evaluations} evaluations{answered} in {times.global_s:.1f} s, "
        f"{times.evaluations_per_s:.0f}/s; "
        f"refinement {times.local_s:.1f} s, intervals {times.intervals_s:.1f} s"
    )
    typer.echo(f"written: {', '.join(map(str, written))}")


def _print_parameters(found: Identified) -> None:
    rows = zip(found.verdicts, found.intervals, found.task.choice.values, strict=True)
    typer.echo(f"{'parameter':24}{'before':>12}{'found':>12}   95 % interval")
    withheld = bool(found.withheld)
    for verdict, interval, before in rows:
        text = "not identifiable"
        if verdict.identifiable and withheld:
            text = "withheld"
        elif verdict.identifiable:
            text = " to ".join("open" if side is None else f"{side:.5g}" for side in interval)
        elif verdict.together:
            text += f", not apart from {', '.join(verdict.together)}"
        typer.echo(f"{verdict.name:24}{before:12.5g}{verdict.value:12.5g}   {text}")


def _print_errors(found: Identified) -> None:
    for force in found.forces:
        error = f"{force.force_n:.4g} N, standard error {force.standard_error_n:.2g} N"
        typer.echo(f"friction of a blade, {force.screen}, {force.speed_mm_s:g} mm/s: {error}")
    for role, compared in (("fitted", found.fitted), ("held out", found.held_out)):
        for each in (comparison.error for comparison in compared):
            typer.echo(f"{each.name} ({role}): current {each.rms_current_a:.4g} A rms, noise {each.noise_a:.4g} A")
    for line in found.withheld:
        typer.echo(line, err=True)
