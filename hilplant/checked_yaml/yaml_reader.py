"""YAML text -> plain Python data, with the line of every key and item.

Scalars follow the core schema of YAML 1.2: only `true` and `false` are booleans; `on`, `off`, `yes` and `no`
stay text, and `1e-3` is a number. PyYAML, which reads YAML 1.1, serves for the syntax alone.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import yaml

from hilplant.checked_yaml.problems import Problem, Severity

#: Where a value stands in the data: the keys and indices that lead to it.
Location = tuple[str | int, ...]

#: So many values a file may have, aliases followed; nobody writes more, and aliases of aliases make billions.
MOST_VALUES = 100_000
#: A whole number of more characters is beyond every float.
_LONGEST_INTEGER = 250

_MERGE = "merge keys (<<) are not supported; write the keys out here, or take a whole group over: `key: *name`"
_STANDARD_TAGS = frozenset(f"tag:yaml.org,2002:{kind}" for kind in ("str", "seq", "map"))
_WORDS = {"": None, "~": None} | {
    spelling: value
    for word, value in (("null", None), ("true", True), ("false", False))
    for spelling in (word, word.capitalize(), word.upper())
}
_INTEGER = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_REAL = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_INFINITE = re.compile(r"([-+]?)\.(inf|Inf|INF)")


@dataclass
class Document:
    """Plain data from one file, or from files over one another, with the place of every key and item."""

    file: str
    data: Any = None
    places: dict[Location, tuple[str, int]] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)

    def place(self, location: Sequence[str | int]) -> tuple[str, int]:
        """Return file and line of the value at `location`, or of the nearest thing around it that exists."""
        steps = tuple(location)
        while steps and steps not in self.places:
            steps = steps[:-1]
        return self.places.get(steps, (self.file, 1))

    def problem(self, location: Sequence[str | int], text: str, severity: Severity = "error") -> Problem:
        """Return a problem at the line of `location`."""
        file, line = self.place(location)
        return Problem(file, line, text, severity, tuple(location))

    def existing(self, location: Sequence[str | int]) -> Location:
        """Drop from a location what the files do not hold, such as the names of the choices of a union."""
        found: Location = ()
        for step in location:
            if (*found, step) in self.places:
                found = (*found, step)
        return found

    def at(self, location: Sequence[str | int]) -> Any:
        """Return the value at `location`, None where there is none."""
        value = self.data
        for step in location:
            if isinstance(value, list) and isinstance(step, int) and step < len(value):
                value = value[step]
            elif isinstance(value, dict):
                value = value.get(step)
            else:
                return None
        return value

    def replace(self, location: Location, value: Any) -> None:
        """Put another value at a location that exists."""
        self.at(location[:-1])[location[-1]] = value

    def put(self, location: Location, part: "Document", named: str) -> None:
        """Put another file's data where it is named; the naming line is kept as that of the step `named` within."""
        self.replace(location, part.data if part.data is not None else {})
        self.places[(*location, named)] = self.places[location]
        self.places |= {(*location, *inner): place for inner, place in part.places.items()}
        self.places[location] = part.place(())


def read_text(text: str, file: str) -> Document:
    """Read one YAML document; what is wrong with its syntax, and keys that come twice, are its `problems`."""
    document = Document(file)
    try:
        root = yaml.compose(text, Loader=yaml.BaseLoader)
        if root is not None:
            document.data = _value(root, (), document)
    except yaml.YAMLError as error:
        document.data = None
        document.problems = [Problem(file, _line_of(error), _reason(error))]
    except _TooManyValuesError:
        text = f"it has more than {MOST_VALUES} values once its aliases are followed; write them out, or fewer"
        return Document(file, problems=[Problem(file, 1, text)])
    except RecursionError:
        document.data = None
        document.problems = [Problem(file, 1, "an alias contains itself, or the file is nested too deeply")]
    return document


def scalar(text: str) -> Any:
    """Return the value of a plain scalar by the core schema of YAML 1.2."""
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text):
        if len(text) > _LONGEST_INTEGER:
            return float("-inf" if text.startswith("-") else "inf")
        return int(text, {"0o": 8, "0x": 16}.get(text[:2], 10))
    if _REAL.fullmatch(text):
        return float(text)
    if infinite := _INFINITE.fullmatch(text):
        return float(f"{infinite[1]}inf")
    return float("nan") if text in (".nan", ".NaN", ".NAN") else text


class _TooManyValuesError(Exception):
    """The file has more values than anybody writes."""


def _value(node: yaml.Node, location: Location, document: Document) -> Any:
    if len(document.places) > MOST_VALUES:
        raise _TooManyValuesError
    document.places.setdefault(location, (document.file, node.start_mark.line + 1))
    if node.tag not in _STANDARD_TAGS:
        text = f"the tag {node.tag} is not known here; leave it out"
        document.problems.append(document.problem(location, text))
    if isinstance(node, yaml.MappingNode):
        return _mapping(node, location, document)
    if isinstance(node, yaml.SequenceNode):
        return [_value(item, (*location, index), document) for index, item in enumerate(node.value)]
    plain = isinstance(node, yaml.ScalarNode) and node.style is None
    return scalar(node.value) if plain else node.value


def _mapping(node: yaml.MappingNode, location: Location, document: Document) -> dict[str, Any]:
    data: dict[str, Any] = {}
    merged: dict[str, Any] = {}
    for key_node, value_node in node.value:
        line = key_node.start_mark.line + 1
        if not isinstance(key_node, yaml.ScalarNode):
            document.problems.append(Problem(document.file, line, "a key must be a single word"))
            continue
        key = key_node.value
        if key == "<<" and key_node.style is None:
            document.problems.append(Problem(document.file, line, _MERGE))
            parts = _value(value_node, (*location, key), document)  # taken over, or its keys would be told as missing
            for part in parts if isinstance(parts, list) else [parts]:
                merged = (part if isinstance(part, dict) else {}) | merged
            continue
        if key in data:
            first = document.place((*location, key))[1]
            text = f"key '{key}' comes twice, first in line {first}"
            document.problems.append(Problem(document.file, line, text))
            continue
        document.places[(*location, key)] = (document.file, line)
        data[key] = _value(value_node, (*location, key), document)
    return merged | data


def _line_of(error: yaml.YAMLError) -> int:
    mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
    return mark.line + 1 if mark is not None else 1


def _reason(error: yaml.YAMLError) -> str:
    parts = [getattr(error, name, None) for name in ("context", "problem", "reason")]
    return "not YAML: " + (", ".join(part for part in parts if part) or str(error).splitlines()[0])
