"""The bus database of a bench: its messages by name."""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from hilplant import resources
from hilplant.bus.database import DatabaseError, load_sound
from hilplant.bus.sound_dbc import LeftOut
from hilplant.checked_yaml.problems import suggestion
from hilplant.checked_yaml.reading import shown
from hilplant.checked_yaml.spot import Spot

_LINE = re.compile(r"\bat line (\d+)")


class Database:
    """Messages by name."""

    def __init__(self, messages: Sequence[Any], file: str, left_out: Sequence[LeftOut] = ()) -> None:
        """Keep the messages, the file's name for what is said about it, and what of it could not be read."""
        self._reasons = {each.message: each.text for each in left_out if each.message is not None}
        self._left_out = left_out
        self._messages = {message.name: message for message in messages}
        self._names = Counter(message.name for message in messages)
        self._file = file

    def missing(self, names: Iterable[str]) -> list[str]:
        """Return those of the names that no message has, be it one that cannot be read."""
        return [name for name in names if name not in self._messages and name not in self._reasons]

    def warn_of_left_out(self, spot: Spot) -> None:
        """Note as a warning what of the file could not be read."""
        if not self._left_out:
            return
        messages = [f"{name} ({text})" for name, text in self._left_out if name is not None]
        others = [text for name, text in self._left_out if name is None]
        counts = f"{len(messages)} messages and {len(others)} other entries"
        first = "; ".join([*messages, *others][:3])
        spot.warn(text=f"{self._file}: left out {counts} that cannot be read: {first}")

    def message(self, spot: Spot) -> Any | None:
        """Return the message that a group of the bench is named after; None, noted, when there is not one."""
        if self._names[spot.name] > 1:
            spot.note(text=f"{self._file} has {self._names[spot.name]} messages '{spot.name}'; keep one")
            return None
        if spot.name in self._reasons:
            spot.note(text=f"{self._file}: message '{spot.name}' cannot be read: {self._reasons[spot.name]}")
        elif spot.name not in self._messages:
            text = f"{self._file} has no message '{spot.name}'{suggestion(spot.name, self._messages)}"
            spot.note(text=text)
        return self._messages.get(spot.name)


def read_database(spot: Spot, name: str | None) -> Database | None:
    """Read the database that is named at a spot of the bench; what is wrong with it is noted there."""
    if name is None:
        return None
    path = resources.find(name, Path())
    try:
        if path is None:
            raise DatabaseError(f"no file '{name}'")
        return _read(path, path.stat().st_mtime_ns)
    except DatabaseError as error:
        spot.note(text=str(error))
    return None


def line_of(error: str) -> int | None:
    """Return the line of the database that an error of its parser names."""
    found = _LINE.search(error)
    return int(found[1]) if found else None


@lru_cache(maxsize=4)
def _read(path: Path, changed_ns: int) -> Database:
    """Read a database once for all phases; `changed_ns` tells a changed file from its former self."""
    database, left_out = load_sound(path)
    return Database(database.messages, shown(path), left_out)
