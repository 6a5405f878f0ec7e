"""Reads the files of one bench or scenario, and collects all that is wrong with them."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from hilplant import resources
from hilplant.checked_yaml.checked import Checked, text_of
from hilplant.checked_yaml.draft import Draft
from hilplant.checked_yaml.problems import BenchError, Problem
from hilplant.checked_yaml.spot import NAMED, Finding
from hilplant.checked_yaml.yaml_reader import Document, Location, read_text

Description = TypeVar("Description", bound=Checked)


class Reading:
    """The files read so far and what is wrong with them."""

    def __init__(self) -> None:
        """Begin with nothing read and nothing wrong."""
        self.problems: list[Problem] = []
        self.sources: dict[str, str] = {}
        self._wrong: set[Location] = set()

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

    def given_text(self, text: str, name: Path) -> Document:
        """Read text that no file holds."""
        self.sources[str(name)] = text
        return self._document(text, name)

    def file(self, path: Path) -> Document | str:
        """Read a YAML file; return why it cannot be read."""
        try:
            return self._document(self.text(path), path)
        except (OSError, UnicodeDecodeError) as error:
            return f"cannot be read: {reason(error)}"

    def referred_file(self, document: Document, location: Location) -> Document | None:
        """Read the YAML file whose name stands at `location`; when that fails, the mistake is there."""
        path = self.referred_path(document, location)
        found = self.file(path) if path is not None else ""
        if isinstance(found, Document):
            return None if found.problems and found.data is None else found
        if found:
            self.note(document, location, f"'{document.at(location)}' {found}")
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
        self._wrong.add(location)
        self.problems.append(document.problem(location, text))

    def take(self, document: Document, location: Location, model: type[Description]) -> Description | None:
        """Check the data at `location` against its description; None when something is wrong with it."""
        return self.check(document, location, document.at(location), model)

    def check(self, document: Document, location: Location, data: Any, model: type[Description]) -> Description | None:
        """Check `data`, which came from `location`, against its description."""
        before = len(self.problems)
        checked = self.draft(document, location, data, model)
        return checked if len(self.problems) == before else None

    def draft(self, document: Document, location: Location, data: Any, model: type[Description]) -> Description | None:
        """Return what `data` describes, with a hole wherever it is wrong; what is wrong is kept."""
        draft = Draft(data, location)
        try:
            found = model.model_validate(data, context=draft)
        except ValidationError as error:  # the data is no group at all
            found = None
            for detail in error.errors(include_url=False):
                draft.note((*location, *detail["loc"]), text_of(detail))
        self.keep(document, draft.findings)
        return found

    def keep(self, document: Document, findings: Sequence[Finding]) -> None:
        """Keep what was found in a description as problems with file and line."""
        for finding in findings:
            if finding.unless_wrong and any(_is_within(wrong, finding.location) for wrong in self._wrong):
                continue
            at = document.existing(finding.location)
            steps = ".".join(str(step) for step in finding.location if step != NAMED)
            text = finding.text if document.places or not steps else f"{steps}: {finding.text}"
            self.problems.append(document.problem(at, text, finding.severity))
        self._wrong |= {finding.location for finding in findings if finding.severity == "error"}

    def sorted_problems(self) -> tuple[Problem, ...]:
        """Return every problem once, by file and line."""
        return tuple(sorted(dict.fromkeys(self.problems)))

    def raise_problems(self) -> None:
        """Refuse to go on when anything was wrong."""
        if self.problems:
            raise BenchError(self.sorted_problems())

    def _document(self, text: str, path: Path) -> Document:
        document = read_text(text, shown(path))
        if document.data is not None and not isinstance(document.data, dict):  # its content is nobody's business
            document.data = None
            document.problems.append(Problem(document.file, 1, "must be a group of keys, such as `name: ...`"))
        self.problems.extend(document.problems)
        return document


def _is_within(location: Location, outer: Location) -> bool:
    return location[: len(outer)] == outer


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
