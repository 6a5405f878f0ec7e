"""A bench's text with all that it names -> plain data, in which each value's file and line are remembered.

`extends` is merged, files of parts stand where they were named, and the database is found. What cannot be read is a
problem, and a hole in the data.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from hilplant import resources
from hilplant.bench.database import line_of, read_database
from hilplant.bench.inheritance import drop_strangers, read_bases
from hilplant.bench.load_files import POLYNOMIAL_FORMAT, TORQUE_FORMAT
from hilplant.bench.motor_network_file import FORMAT as MOTOR_FORMAT
from hilplant.checked_yaml.checksummed import flaw_of
from hilplant.checked_yaml.draft import HOLE
from hilplant.checked_yaml.problems import Problem
from hilplant.checked_yaml.reading import Reading, shown
from hilplant.checked_yaml.spot import NAMED, Spot
from hilplant.checked_yaml.yaml_reader import Document, Location

#: What a bench that is given as text is called in messages.
TEXT = Path("(text)")

_PARTS: tuple[Location, ...] = (("plant", "motor"), ("plant", "linkage"), ("plant", "screen"))
#: Where trained files are named, and the format that goes with the model beside it.
_TRAINED: tuple[tuple[Location, dict[str, str]], ...] = (
    (("plant", "load"), {"network": TORQUE_FORMAT, "polynomial": POLYNOMIAL_FORMAT}),
    (("plant", "motor_model"), {"narx": MOTOR_FORMAT}),
)
_DATABASE: Location = ("bus", "database")


@dataclass(frozen=True, slots=True)
class Source:
    """A bench as it was written: its data, and what was wrong with reading it."""

    path: Path
    document: Document
    reading: Reading = field(default_factory=Reading)

    @property
    def is_readable(self) -> bool:
        """Whether there is anything to check."""
        return self.document.data is not None or not self.reading.problems


def read_source(source: str | Path) -> Source:
    """Read a bench: a path, the name of a shipped one, or YAML text."""
    reading = Reading()
    if is_text(source):
        path, first = TEXT, reading.given_text(str(source), TEXT)
    else:
        path = resources.named("benches", source)
        first = reading.named_file(path)
    document = read_bases(reading, first)
    if isinstance(document.data, dict):
        _read_parts(reading, document)
    return Source(path, document, reading)


def is_text(source: str | Path) -> bool:
    """Say whether a bench is given as YAML text; no path holds a line's end or a key with its value."""
    return isinstance(source, str) and ("\n" in source or ": " in source)


def _read_parts(reading: Reading, document: Document) -> None:
    for location in _PARTS:
        _put(reading, document, location, partial(_part, reading))
    for around, formats in _TRAINED:
        wanted = formats.get(str(document.at((*around, "model"))))
        if wanted is not None:
            _put(reading, document, (*around, "file"), partial(_trained, reading, wanted))
    _find_database(reading, document)


def _put(reading: Reading, document: Document, location: Location, read: Callable[[Path], Document | str]) -> None:
    """Put what a file holds where it is named, a hole if it cannot be read."""
    name = document.at(location)
    if not isinstance(name, str) or not name:
        return  # the part itself, or nothing sensible, which its description says
    path = reading.referred_path(document, location)
    found = read(path) if path is not None else ""
    if isinstance(found, Document):
        document.put(location, found, NAMED)
        return
    if found:
        reading.note(document, location, f"'{name}' {found}")
    document.replace(location, HOLE)


def _part(reading: Reading, path: Path) -> Document | str:
    """Return a part's file; why it cannot be read, or nothing when that has been noted."""
    found = reading.file(path)
    return found if isinstance(found, str) or found.data is not None or not found.problems else ""


def _trained(reading: Reading, wanted: str, path: Path) -> Document | str:
    return flaw_of(path, wanted) or _part(reading, path)


def _find_database(reading: Reading, document: Document) -> None:
    if not isinstance(document.at(_DATABASE), str) or not document.at(_DATABASE):
        return
    path = reading.referred_path(document, _DATABASE)
    database = None
    if path is not None:
        spot = Spot(_DATABASE)
        database = read_database(spot, str(path))
        reading.sources[shown(path)] = path.read_text(encoding="utf-8", errors="replace")
        for finding in spot.findings:
            _note_database(reading, document, path, finding.text)
    document.replace(_DATABASE, str(path) if database is not None else HOLE)
    if database is not None:
        drop_strangers(reading, document, database)


def _note_database(reading: Reading, document: Document, path: Path, text: str) -> None:
    """Keep a mistake at the database's line if the parser names it, else where the bench names the file."""
    if (line := line_of(text)) is not None:
        reading.problems.append(Problem(shown(path), line, text))
    else:
        reading.note(document, _DATABASE, text)
