"""CAN frames as any log has them, and what is to read them: `FILE.dbc`, `BENCH`, or either with `@CHANNEL`."""

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple


class LoggedFrame(NamedTuple):
    """A data frame; `channel` is the bus as its log names it, "" where it names none."""

    time_s: float
    identifier: int
    extended: bool
    data: bytes
    channel: str


class FrameSource(NamedTuple):
    """The bus database or the bench that reads frames, and the one channel of the log that is taken."""

    database: Path | None = None
    bench: str | None = None
    channel: str | None = None

    def __str__(self) -> str:
        """Return the name of database or bench, as on the command line."""
        return str(self.database or self.bench)


class LoggedFrames(NamedTuple):
    """The frames of a log in its order; `notes` are complete once all frames were taken."""

    frames: Iterable[LoggedFrame]
    notes: list[str]


def frame_source(text: str | None) -> FrameSource:
    """Read what the option --frames says: a database by its ending, else a bench; the channel behind an @."""
    if text is None:
        return FrameSource()
    name, at, channel = text.rpartition("@") if "@" in text and not Path(text).exists() else (text, "", "")
    is_database = Path(name).suffix.lower() not in ("", ".yaml", ".yml")
    return FrameSource(Path(name) if is_database else None, None if is_database else name, channel if at else None)
