"""What is wrong with a file that a user wrote, and where."""

from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches

from hilplant.failure import Failure


@dataclass(frozen=True, order=True, slots=True)
class Problem:
    """One mistake: the file and line it is in, and what would be right."""

    file: str
    line: int
    text: str

    def __str__(self) -> str:
        """Return the line that the user sees."""
        return f"{self.file}:{self.line}: {self.text}"


class BenchError(Failure):
    """Nothing starts with these files; each problem is one line of the message."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        """Keep the problems and join their lines."""
        self.problems = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))


def suggestion(word: str, known: Iterable[str]) -> str:
    """Return how a sentence about an unknown word ends: with the nearest known word, or with all of them."""
    names = sorted(known)
    near = get_close_matches(word, names, n=1, cutoff=0.5)
    if near:
        return f", did you mean '{near[0]}'?"
    return f"; known: {', '.join(names)}" if names else ""
