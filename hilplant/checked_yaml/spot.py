"""Where in a description something stands, and what is found there."""

from dataclasses import dataclass, field
from typing import NamedTuple

from hilplant.checked_yaml.problems import Severity
from hilplant.checked_yaml.yaml_reader import Location

#: Last step of the location at which a file is named; without it, the location is that of the file's content.
NAMED = "(file)"


class Finding(NamedTuple):
    """What was found at a location; the reader of the files knows which file and line that is.

    With `unless_wrong` it only counts when nothing else was wrong there: what is missing may just not be readable.
    """

    location: Location
    text: str
    severity: Severity = "error"
    unless_wrong: bool = False


@dataclass(frozen=True, slots=True)
class Spot:
    """A location within a description; what is noted at any spot of one description goes to the same list."""

    location: Location = ()
    findings: list[Finding] = field(default_factory=list)

    @property
    def name(self) -> str:
        """The key under which the group stands."""
        return str(self.location[-1])

    def inner(self, *keys: str | int) -> "Spot":
        """Return a spot within this one."""
        return Spot((*self.location, *keys), self.findings)

    def note(self, *inner: str | int, text: str) -> None:
        """Keep an error at a key within this spot."""
        self.findings.append(Finding((*self.location, *inner), text))

    def miss(self, *inner: str | int, text: str) -> None:
        """Keep that a key is missing, unless what stands there was wrong."""
        self.findings.append(Finding((*self.location, *inner), text, unless_wrong=True))

    def warn(self, *inner: str | int, text: str) -> None:
        """Keep a warning at a key within this spot."""
        self.findings.append(Finding((*self.location, *inner), text, "warning"))
