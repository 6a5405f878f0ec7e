"""The progress of an identification: best cost and time left, as a line that moves, or some lines where none can."""

import time
from types import TracebackType

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from hilplant.identify import genetic

#: Where no line can move, one is written this often [s].
_EVERY_S = 10.0


class ProgressDisplay:
    """Hears of each generation and of each round of the refinement; `most` evaluations make the search complete."""

    def __init__(self, most: int) -> None:
        console = Console(stderr=True)
        self._moves = console.is_terminal
        stage, told = TextColumn("{task.description}"), TextColumn("{task.fields[told]}")
        columns = (stage, BarColumn(), told, TimeRemainingColumn())
        self._bar = Progress(*columns, console=console, transient=True)
        self._task = self._bar.add_task("search", total=most, told="")
        self._said = time.monotonic()

    def __enter__(self) -> "ProgressDisplay":
        """Begin to show."""
        if self._moves:
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        """End, and leave nothing behind."""
        if self._moves:
            self._bar.stop()

    def __call__(self, stage: str, seen: genetic.Progress | float) -> None:
        """Show where it stands."""
        if isinstance(seen, genetic.Progress):
            text = f"lowest cost {seen.best:.4g}, {seen.evaluations} evaluations"
            self._bar.update(self._task, completed=seen.evaluations, told=text)
        else:
            text = f"current {seen:.4g} A rms"
            self._bar.update(self._task, description=stage, told=text)
        if not self._moves and time.monotonic() - self._said > _EVERY_S:
            self._said = time.monotonic()
            typer.echo(f"{stage}: {text}", err=True)
