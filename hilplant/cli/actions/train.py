"""Runs a training with its progress shown, and prints what came of it."""

from collections.abc import Callable
from pathlib import Path

import typer

from hilplant.cli.options import write_json
from hilplant.cli.progress import progress_shown
from hilplant.progress import OnProgress
from hilplant.reports.page import TrainingReport


def run_training(training: Callable[[OnProgress], TrainingReport], json_file: Path | None) -> None:
    """Print the lines of a training, write its figures; exit code 1 when it did not keep what its file states."""
    with progress_shown() as on_progress:
        report = training(on_progress)
    typer.echo("\n".join(report.lines))
    write_json(json_file, report.figures)
    raise typer.Exit(0 if report.kept else 1)
