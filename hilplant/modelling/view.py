"""What the page shows of a model: its texts, its values, where they come from, and all that is wrong with it."""

from dataclasses import dataclass
from typing import Any

from hilplant.bench import Bench, BenchError, Problem, load_bench
from hilplant.bench.summary import summary_lines
from hilplant.checked_yaml.draft import HOLE
from hilplant.checked_yaml.yaml_reader import Location
from hilplant.modelling.model_files import LaidOut, ModelFiles


@dataclass(frozen=True, slots=True)
class ModelCheck:
    """A model after its check: the bench, if nothing is wrong, its values, problems, and keys that are inherited.

    Problems name the files as the model does, and the keys that lead to the value.
    """

    bench: Bench | None
    values: dict[str, Any]
    problems: tuple[Problem, ...]
    inherited: dict[Location, str]

    @property
    def lines(self) -> list[str]:
        """Return what the bench amounts to, as `hilplant check` says it."""
        return summary_lines(self.bench) if self.bench is not None else []


def checked(model: ModelFiles) -> ModelCheck:
    """Check a model as `hilplant check` does."""
    with model.laid_out() as here:
        source = here.read()
        values = plain(source.document.data) if isinstance(source.document.data, dict) else {}
        places = source.document.places
        inherited: dict[Location, str] = {
            key: here.name_of(file)
            for key, (file, _) in places.items()
            if len(key) == 2 and here.name_of(file) not in model.texts
        }
        try:
            bench: Bench | None = load_bench(here.bench)
            problems = bench.warnings if bench is not None else ()
        except BenchError as error:
            bench, problems = None, error.problems
        return ModelCheck(bench, values, tuple(_renamed(here, each) for each in problems), inherited)


def _renamed(here: LaidOut, problem: Problem) -> Problem:
    text = problem.text.replace(f"{here.root}/", "")
    return Problem(here.name_of(problem.file), problem.line, text, problem.severity, problem.location)


def plain(value: Any) -> Any:
    """Return data without holes, as JSON takes it."""
    if isinstance(value, dict):
        return {key: plain(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [plain(inner) for inner in value]
    return None if value is HOLE else value
