"""Reads the files of one bench or scenario, and collects all that is wrong with them."""

from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from hilplant import resources
from hilplant.checked_yaml.checked import Checked, problems_of
from hilplant.checked_yaml.problems import BenchError, Problem
from hilplant.checked_yaml.yaml_reader import Document, Location, read_text

Description = TypeVar("Description", bound=Checked)


class Reading:
    """The files read so far and what is wrong with them."""

    def __init__(self) -> None:
        """Begin with nothing read and nothing wrong."""
        self.problems: list[Problem] = []
        self.sources: dict[str, str] = {}

    def text(self, path: Path) -> str:
        """Return a file's text and keep it among the sources; raises OSError or UnicodeDecodeError."""
        text = path.read_text(encoding="utf-8")
        self.sources[shown(path)] = text
        return text

    def named_file(self, path: Path) -> Document:
        """Read the file that the user named."""
        try:
            text = self.text(path)
        except (OSError, UnicodeDecodeError) as error:
            self.problems.append(Problem(shown(path), 1, f"cannot be read: {reason(error)}"))
            return Document(shown(path))
        return self._document(text, path)

    def referred_file(self, document: Document, location: Location) -> Document | None:
        """Read the YAML file whose name stands at `location`; when that fails, the mistake is there."""
        path = self.referred_path(document, location)
        if path is None:
            return None
        try:
            found = self._document(self.text(path), path)
            return None if found.problems and found.data is None else found
        except (OSError, UnicodeDecodeError) as error:
            self.note(document, location, f"'{document.at(location)}' cannot be read: {reason(error)}")
            return None

    def referred_path(self, document: Document, location: Location) -> Path | None:
        """Find the file named at `location`, beside the file that names it or among the shipped ones."""
        name = document.at(location)
        if not isinstance(name, str) or not name:
            return None  # its section has been told so
        beside = Path(document.place(location)[0]).parent
        path = resources.find(name, beside)
        if path is None:
            folders = ", ".join(shown(folder) for folder in (beside, *resources.shared_folders()))
            self.note(document, location, f"no file '{name}'; looked in {folders}")
        return path

    def note(self, document: Document, location: Location, text: str) -> None:
        """Keep a problem at the line of `location`."""
        self.problems.append(document.problem(location, text))

    def take(self, document: Document, location: Location, model: type[Description]) -> Description | None:
        """Check the data at `location` against its description; None when something is wrong with it."""
        return self.check(document, location, document.at(location), model)

    def check(self, document: Document, location: Location, data: Any, model: type[Description]) -> Description | None:
        """Check `data`, which came from `location`, against its description."""
        try:
            return model.model_validate(data)
        except ValidationError as error:
            self.problems.extend(problems_of(error, document, location))
            return None

    def raise_problems(self) -> None:
        """Refuse to go on when anything was wrong."""
        if self.problems:
            raise BenchError(sorted(dict.fromkeys(self.problems)))

    def _document(self, text: str, path: Path) -> Document:
        document = read_text(text, shown(path))
        self.problems.extend(document.problems)
        return document


def shown(path: Path) -> str:
    """Return a path as messages show it: from the working directory where it lies below it."""
    try:
        return str(path.resolve().relative_to(Path.cwd())) or "."
    except ValueError:
        return str(path)


def reason(error: OSError | UnicodeDecodeError) -> str:
    """Return why a file could not be read."""
    if isinstance(error, OSError):
        return (error.strerror or str(error)).lower()
    return f"it is not UTF-8 text (byte {error.start})"
