"""The progress of something long on stderr: a bar that moves, or a line now and then where none can."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from hilplant.progress import OnProgress, ProgressReport

#: Where no bar can move, a line is written this often [s].
_EVERY_S = 10.0


@contextmanager
def progress_shown() -> Iterator[OnProgress]:
    """Show what the yielded callback is told; nothing of it stays on a terminal."""
    console = Console(stderr=True)
    if console.is_terminal:
        columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[note]}"))
        with Progress(*columns, TimeRemainingColumn(), console=console, transient=True) as bar:
            task = bar.add_task("", note="")
            yield lambda seen: bar.update(
                task, description=seen.stage, completed=seen.done, total=seen.total, note=seen.note
            )
        return
    last_s = time.monotonic()

    def write_line(seen: ProgressReport) -> None:
        nonlocal last_s
        if time.monotonic() - last_s > _EVERY_S:
            last_s = time.monotonic()
            line = f"{seen.stage}: {seen.done:.0f} of {seen.total:.0f}" + (f", {seen.note}" if seen.note else "")
            console.print(line, highlight=False, markup=False, soft_wrap=True)

    yield write_line
