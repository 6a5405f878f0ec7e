"""Recordings as a command line names them: FILE, FILE@dry, FILE@wet,fast."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from hilplant.failure import Failure
from hilplant.measurements.checks import refuse
from hilplant.measurements.columns import parse_columns
from hilplant.measurements.files import Origin
from hilplant.measurements.frames import frame_source
from hilplant.measurements.measurement import Measurement
from hilplant.measurements.preparation import Preparation, read_measurement
from hilplant.signals import SCREENS

_MODES = ("slow", "fast")


class Named(NamedTuple):
    """A recording, how it was named, the wetness of its screen, and what is to be known of it."""

    text: str
    data: Measurement
    screen: float
    notes: tuple[str, ...]


def read_named(texts: Sequence[str], columns: str, frames: str | None) -> list[Named]:
    """Read and judge recordings; the screen is dry where nothing is said.

    Raises
    ------
    Failure
        For a name that cannot be understood, and for data that are wrong: one line for each finding.

    """
    return [_read(text, columns, frames) for text in texts]


def _read(text: str, columns: str, frames: str | None) -> Named:
    name, _, words = text.rpartition("@") if "@" in text and not Path(text).exists() else (text, "", "")
    screen, mode = 0.0, None
    screens = dict(SCREENS)
    for word in filter(None, words.split(",")):
        if word in screens:
            screen = screens[word]
        elif word in _MODES:
            mode = word
        else:
            raise Failure(f"{text}: behind @ may stand {', '.join((*screens, *_MODES))}, not '{word}'")
    origin = Origin(Path(name), None, frame_source(frames))
    data = read_measurement(origin, parse_columns(columns), Preparation(mode=mode))
    found = refuse(data)
    return Named(text, data, screen, tuple(f"{name}: {note}" for note in (*data.notes, *(each.text for each in found))))
