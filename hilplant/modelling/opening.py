"""A bench, shipped or of the user -> the files that are to be changed; parts from the library in place of others."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from hilplant import resources
from hilplant.bench.source import read_source
from hilplant.checked_yaml.editing import with_value
from hilplant.checked_yaml.problems import BenchError
from hilplant.checked_yaml.spot import NAMED
from hilplant.checked_yaml.yaml_reader import Document, Location
from hilplant.failure import Failure
from hilplant.modelling.model_files import BENCH, PARTS, ModelFiles
from hilplant.resources import named, shipped

#: What is opened when nothing is named: the printed defaults of Figure 8-3.
DEFAULTS = "figure_8_3"

_FOLDERS = {"motor": "motors", "linkage": "linkages", "screen": "screens"}
#: Files that a bench names besides; those of the user's that lie elsewhere come along.
_NAMED: tuple[Location, ...] = (
    ("extends",), ("bus", "database"), ("plant", "load", "file"), ("plant", "motor_model", "file"),
)  # fmt: skip
_OVER_SHIPPED = """\
# Over the shipped bench {base}: what differs from it is written here, and docs/bench.md explains every key.
extends: {base}.yaml
name: my_{base}
plant:
  motor: motor.yaml
  linkage: linkage.yaml
  screen: screen.yaml
"""


def open_model(bench: str | Path = DEFAULTS) -> ModelFiles:
    """Open a bench by its path or, for a shipped one, its name.

    A shipped bench is opened as a new one over it, with the texts of its parts. Of a user's bench, parts that are
    shipped are copied beside it, so that they can be changed.

    Raises
    ------
    Failure
        When there is no such bench; BenchError when one of its files cannot be read.

    """
    path = named("benches", bench)
    source = read_source(path)
    if source.document.data is None:
        raise BenchError(source.reading.sorted_problems())
    if _is_shipped(path):
        parts = dict(_parts(source.document))
        return ModelFiles({BENCH: _OVER_SHIPPED.format(base=path.stem), **_texts(parts, source.document)})
    return _of_user(path.resolve(), source.document, list(source.reading.sources))


def with_library_part(model: ModelFiles, part: str, name: str) -> ModelFiles:
    """Return a model with a shipped motor, linkage or screen in place of the one that it has.

    Raises
    ------
    Failure
        When there is no such part.

    """
    if part not in PARTS:
        raise Failure(f"there is no part '{part}'; there are {', '.join(PARTS)}")
    path = shipped("config", _FOLDERS[part], f"{Path(name).stem}.yaml")
    if not path.is_file():
        raise Failure(f"{name}: none of the shipped {_FOLDERS[part]}")
    return with_part(model, part, path.read_text(encoding="utf-8"))


def with_part(model: ModelFiles, part: str, text: str) -> ModelFiles:
    """Return a model with this text as its motor, linkage or screen."""
    with model.laid_out() as here:
        document = here.read().document
        file = here.name_of(document.place(("plant", part))[0])
    if file not in model.texts or file == model.bench:
        file = PARTS[part]
        bench = with_value(model.texts[model.bench], ("plant", part), file)
        model = replace(model, texts={**model.texts, model.bench: bench})
    return replace(model, texts={**model.texts, file: text})


def _of_user(path: Path, document: Document, files: list[str]) -> ModelFiles:
    folder, bench = path.parent, path.read_text(encoding="utf-8")
    others: dict[str, bytes] = {}
    for file in map(Path, files):
        inside = file.resolve()
        if not _is_shipped(inside) and inside != path and inside.is_relative_to(folder):
            others[inside.relative_to(folder).as_posix()] = inside.read_bytes()
    texts: dict[str, str] = {}
    for part, file in _parts(document):
        inside = file.resolve()
        if inside == path:
            continue  # it stands in the bench itself
        if inside.is_relative_to(folder) and not _is_shipped(inside):
            name = inside.relative_to(folder).as_posix()
        else:
            name = _free(PARTS[part], others)
            bench = with_value(bench, ("plant", part), name)
        texts[name] = inside.read_text(encoding="utf-8")
    for location in _NAMED:
        bench = _brought_along(bench, document, location, others)
    kept = {name: content for name, content in others.items() if name not in texts}
    on_disk = {name: (folder / name).read_bytes() for name in (path.name, *texts, *kept) if (folder / name).is_file()}
    return ModelFiles({path.name: bench, **texts}, path.name, kept, folder, on_disk)


def _brought_along(bench: str, document: Document, location: Location, others: dict[str, bytes]) -> str:
    """Take a file that the bench itself names outside its folder into the folder, and change the name."""
    from hilplant.checked_yaml.yaml_reader import read_text

    name = read_text(bench, "bench").at(location)
    if not isinstance(name, str) or name in others:
        return bench
    file = resources.find(name, Path(document.file).parent)
    if file is None or _is_shipped(file.resolve()):
        return bench
    inside = _free(file.name, others)
    others[inside] = file.read_bytes()
    return with_value(bench, location, inside)


def _free(name: str, taken: dict[str, bytes]) -> str:
    """Return a name that no other file has."""
    stem, ending = Path(name).stem, Path(name).suffix
    tried = [name, *(f"{stem}_{number}{ending}" for number in range(2, 100))]
    return next(each for each in tried if each not in taken)


def _parts(document: Document) -> Iterator[tuple[str, Path]]:
    """Yield the parts that stand in a file of their own, or in the bench, with the file."""
    for part in PARTS:
        if ("plant", part) in document.places and isinstance(document.at(("plant", part)), dict):
            yield part, Path(document.place(("plant", part))[0])


def _texts(parts: dict[str, Path], document: Document) -> dict[str, str]:
    wrong = [part for part in PARTS if (part in parts) != (("plant", part, NAMED) in document.places)]
    if wrong or len(parts) != len(PARTS):
        raise Failure(f"{document.file}: a shipped bench names a file for each of {', '.join(PARTS)}")
    return {PARTS[part]: path.read_text(encoding="utf-8") for part, path in parts.items()}


def _is_shipped(path: Path) -> bool:
    return any(path.resolve().is_relative_to(shipped(name).resolve()) for name in ("config", "dbc"))
