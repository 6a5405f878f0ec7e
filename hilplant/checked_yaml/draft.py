"""A description that is being checked: what is wrong with it, and where its groups stand."""

from collections.abc import Iterator
from typing import Any, Final

from hilplant.checked_yaml.spot import Finding
from hilplant.checked_yaml.yaml_reader import Location

#: Stands in the data of a draft where something is missing that has been noted already.
HOLE: Final = object()


class Draft:
    """Passed along as the context of a validation.

    A group of the data that is wrong is noted and becomes a hole, None, in the result, so that the rest can be
    checked all the same. Without findings there are no holes.
    """

    def __init__(self, data: Any, at: Location = ()) -> None:
        """Learn where in the description each group of the data stands."""
        self.findings: list[Finding] = []
        self.holes = 0
        self._data = data  # the identities below are good as long as it is there
        self._locations = {id(group): location for location, group in _groups(data, at)}

    def location(self, group: Any) -> Location | None:
        """Return where a group of the data stands; None for anything else."""
        return self._locations.get(id(group)) if isinstance(group, dict | list) else None

    def hole(self) -> None:
        """Count one more hole."""
        self.holes += 1

    def note(self, location: Location, text: str) -> None:
        """Keep a mistake."""
        self.findings.append(Finding(location, text))


def _groups(data: Any, location: Location) -> Iterator[tuple[Location, Any]]:
    if isinstance(data, dict):
        yield location, data
        for key, inner in data.items():
            yield from _groups(inner, (*location, key))
    elif isinstance(data, list):
        for index, inner in enumerate(data):
            yield from _groups(inner, (*location, index))
