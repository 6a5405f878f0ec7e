"""The bus database of a bench: its messages by name, and its mistakes where they are."""

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hilplant.bus.database import DatabaseError, load_database
from hilplant.checked_yaml.place import Place
from hilplant.checked_yaml.problems import Problem, suggestion
from hilplant.checked_yaml.reading import shown

_LINE = re.compile(r"\bat line (\d+)")


class Database:
    """Messages by name."""

    def __init__(self, messages: Sequence[Any], file: str) -> None:
        """Keep the messages, and the file's name for what is said about it."""
        self._messages = {message.name: message for message in messages}
        self._names = Counter(message.name for message in messages)
        self._file = file

    def has(self, name: str) -> bool:
        """Whether there is a message of this name."""
        return name in self._messages

    def message(self, place: Place) -> Any | None:
        """Return the message that a group of the bench is named after; None, noted, when there is not one."""
        if self._names[place.name] > 1:
            place.note(text=f"{self._file} has {self._names[place.name]} messages '{place.name}'; keep one")
            return None
        if place.name not in self._messages:
            text = f"{self._file} has no message '{place.name}'{suggestion(place.name, self._messages)}"
            place.note(text=text)
        return self._messages.get(place.name)


def read_database(place: Place) -> Database | None:
    """Read the database that is named at a place of the bench."""
    path = place.reading.referred_path(place.document, place.location)
    if path is None:
        return None
    try:
        messages = load_database(path).messages
        place.reading.sources[shown(path)] = path.read_text(encoding="utf-8", errors="replace")
    except DatabaseError as error:
        _note(place, path, error)
        return None
    return Database(messages, shown(path))


def _note(place: Place, path: Path, error: DatabaseError) -> None:
    """Say what is wrong at the database's line if the parser names it, else where the bench does."""
    if found := _LINE.search(str(error)):
        place.reading.problems.append(Problem(shown(path), int(found[1]), str(error)))
    else:
        place.note(text=str(error))
