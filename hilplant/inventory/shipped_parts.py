"""What is shipped of each kind: parameter sets with source and status, benches and scenarios with what they are for."""

import re
from collections.abc import Callable, Iterator
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any, NamedTuple

from hilplant.checked_yaml.reading import Reading
from hilplant.checked_yaml.yaml_reader import Document
from hilplant.ecu.controller_choice import ENTRY_POINTS
from hilplant.failure import Failure
from hilplant.faults.catalogue import BY_NAME
from hilplant.inventory.controllers import CONTROLLERS
from hilplant.resources import shipped

#: Kinds that are folders of `config/`.
FOLDERS = ["motors", "linkages", "screens", "benches", "scenarios", "profiles", "measurements", "surrogates", "tests"]


class ListedPart(NamedTuple):
    """One entry of a list: its name as commands take it, what it is, where it comes from, and its file.

    `status` is measured, identified, published or assumed for parameter sets; trained, shipped or installed otherwise.
    """

    name: str
    about: str
    status: str
    source: str
    file: str = ""


def kinds() -> list[str]:
    """Return the kinds that can be listed."""
    return [*FOLDERS[:5], "controllers", "faults", *FOLDERS[5:]]


def listed(kind: str) -> list[ListedPart]:
    """Return what is shipped of a kind, in the order in which it is best read.

    Raises
    ------
    Failure
        For a kind that there is not.

    """
    if kind not in kinds():
        raise Failure(f"there is no list of {kind}; there are {', '.join(kinds())}")
    makers: dict[str, Callable[[], Iterator[ListedPart]]] = {"controllers": _controllers, "faults": _faults}
    return list(makers[kind]()) if kind in makers else [_part(path) for path in _files(kind)]


def cited(source: str) -> str:
    """Return a source with the thesis' long title as name and year, for lists."""
    return re.sub(r"M\. Dooner, .*?University of Warwick, 2016", "Dooner (2016)", source)


def _files(kind: str) -> list[Path]:
    return sorted(shipped("config", kind).glob("*.yaml"))


def _part(path: Path) -> ListedPart:
    document = Reading().named_file(path)
    if path.parent.name == "surrogates":
        return ListedPart(path.stem, _words(document, "format"), "trained", _words(document, "command"), str(path))
    source, about = _words(document, "source"), _words(document, "title", "name")
    if not source:
        source = "over " + base if (base := _words(document, "extends")) else ""
        about = _words(document, "requirement") or _comment(path) or about
    elif about == path.stem:
        about = _comment(path) or about
    return ListedPart(path.stem, about or path.stem, _words(document, "status") or "shipped", source, str(path))


def _words(document: Document, *keys: str) -> str:
    """Return the text under the first of the keys that is there, on one line."""
    found: Any = next((document.at((key,)) for key in keys if document.at((key,))), "")
    return " ".join(str(found).split())


def _comment(path: Path) -> str:
    """Return the first sentence of the comment at a file's head."""
    lines = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            break
        if "yaml-language-server" not in line:
            lines.append(line[1:].strip())
    return re.split(r"[.:;](?:\s|$)", " ".join(lines))[0]


def _controllers() -> Iterator[ListedPart]:
    for name, (about, status, source) in CONTROLLERS.items():
        yield ListedPart(name, about, status, source)
    yield from (_part(path) for path in _files("controllers"))
    for entry in entry_points(group=ENTRY_POINTS):
        package = entry.dist.name if entry.dist is not None else ""
        yield ListedPart(entry.name, f"in Python, {entry.value}", "installed", package)


def _faults() -> Iterator[ListedPart]:
    for fault in BY_NAME.values():
        yield ListedPart(fault.name, fault.meaning, "shipped", f"{fault.kind}: {fault.effect}")
