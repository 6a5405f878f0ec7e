"""What is wrong with a file that a user wrote, and where."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Literal

from hilplant.failure import Failure

#: An error stops everything; a warning is shown, and the bench runs all the same.
Severity = Literal["error", "warning"]

#: So many known words are named in a message at most.
_MOST_KNOWN = 30


@dataclass(frozen=True, order=True, slots=True)
class Problem:
    """One mistake: the file and line it is in, and what would be right; `location` are the keys that lead there."""

    file: str
    line: int
    text: str
    severity: Severity = "error"
    location: tuple[str | int, ...] = field(default=(), compare=False)

    def __str__(self) -> str:
        """Return the line that the user sees; what would steer a terminal is escaped."""
        warning = "warning: " if self.severity == "warning" else ""
        return visible(f"{self.file}:{self.line}: {warning}{self.text}")


class BenchError(Failure):
    """Nothing starts with these files; each problem is one line of the message."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        """Keep the problems and join their lines."""
        self.problems = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))


def suggestion(word: str, known: Iterable[str]) -> str:
    """Return how a sentence about an unknown word ends: the nearest known word, or all, or the nearest of many."""
    names = sorted(known)
    near = get_close_matches(word, names, n=1, cutoff=0.5)
    if near:
        return f", did you mean '{near[0]}'?"
    if len(names) > _MOST_KNOWN:
        nearest = ", ".join(get_close_matches(word, names, n=3, cutoff=0.0))
        return f"; {len(names)} are known, the nearest are {nearest}"
    return f"; known: {', '.join(names)}" if names else ""


def visible(text: str) -> str:
    """Return a text with control characters as escapes, so that it is one line that a terminal only shows."""
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in text)
