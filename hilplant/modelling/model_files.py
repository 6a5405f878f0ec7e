"""A bench that is being written: its texts by file name, changed value by value, saved as a folder of files."""

import io
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from hilplant import resources
from hilplant.atomic_write import make_folder, write_bytes
from hilplant.bench.source import Source, read_source
from hilplant.checked_yaml.editing import with_value, without
from hilplant.checked_yaml.spot import NAMED
from hilplant.checked_yaml.yaml_reader import Location, read_text
from hilplant.failure import Failure

#: Parts of the plant that have a file of their own, and what it is called in a new folder.
PARTS = {"motor": "motor.yaml", "linkage": "linkage.yaml", "screen": "screen.yaml"}
BENCH = "bench.yaml"


@dataclass(frozen=True, slots=True)
class ModelFiles:
    """The files of a bench by their name, relative to one folder.

    `texts` can be changed; `others` are what the bench needs besides, such as a database. `folder` is where they were
    last read or saved, None for what was never saved; `on_disk` is what stood there then.
    """

    texts: Mapping[str, str]
    bench: str = BENCH
    others: Mapping[str, bytes] = field(default_factory=dict)
    folder: Path | None = None
    on_disk: Mapping[str, bytes] = field(default_factory=dict)

    @property
    def contents(self) -> dict[str, bytes]:
        """Return every file as it would be written."""
        return {**self.others, **{name: text.encode() for name, text in self.texts.items()}}

    @property
    def is_saved(self) -> bool:
        """Whether the folder holds what is here."""
        return self.folder is not None and dict(self.on_disk) == self.contents

    @contextmanager
    def laid_out(self) -> Iterator["LaidOut"]:
        """Write all files into a folder that is there for as long as the block lasts."""
        with tempfile.TemporaryDirectory(prefix="hilplant-model-") as folder:
            yield LaidOut(self.written_to(Path(folder).resolve()), Path(folder).resolve())

    def written_to(self, folder: Path) -> Path:
        """Write all files into a folder; return the path of the bench."""
        for name, content in self.contents.items():
            make_folder((folder / name).parent)
            write_bytes(folder / name, content)
        return folder / self.bench

    def with_text(self, name: str, text: str) -> "ModelFiles":
        """Return the same with another text of one file.

        Raises
        ------
        Failure
            When there is no such file.

        """
        if name not in self.texts:
            raise Failure(f"there is no file {name}; there are {', '.join(self.texts)}")
        return replace(self, texts={**self.texts, name: text})

    def with_value(self, location: Location, value: Any) -> "ModelFiles":
        """Return the same with another value at keys of the whole description, such as (plant, motor, gear_ratio).

        The value is changed in the file in which it stands. What a bench inherits is written into it with the key that
        it belongs to, whole, as `extends` takes it. None takes a key out.

        Raises
        ------
        EditError
            When it cannot be changed where it stands.

        """
        with self.laid_out() as here:
            name, inner, inherited = here.where(self, location)
        if inherited is None:
            return self.with_text(name, _changed(self.texts[name], inner, value))
        whole = _changed(with_value("", ("inherited",), inherited), ("inherited", *location[2:]), value)
        written = read_text(whole, name).at(("inherited",))
        return self.with_text(name, with_value(self.texts[name], location[:2], written))

    def saved(self, folder: Path, overwrite: bool = False) -> "ModelFiles":
        """Write all files into a folder, and return them as saved there.

        Raises
        ------
        Failure
            When the folder is of the shipped files, when it holds files of these names that were changed by others or
            were never read (unless `overwrite`), or when it cannot be written.

        """
        target = folder.expanduser().resolve()
        shipped = (resources.shipped("config"), resources.shipped("dbc"))
        if any(target.is_relative_to(each.resolve()) for each in shipped):
            raise Failure(f"{folder}: holds the shipped files, which stay as they are; save elsewhere")
        known = self.on_disk if self.folder == target else {}
        for name in self.contents:
            path = target / name
            if path.is_file() and not overwrite and path.read_bytes() != known.get(name):
                raise Failure(f"{path}: is there already, with another content; save elsewhere, or overwrite it")
        self.written_to(target)
        return replace(self, folder=target, on_disk=self.contents)

    def zipped(self) -> bytes:
        """Return all files as a zip archive."""
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in sorted(self.contents.items()):
                archive.writestr(name, content)
        return stream.getvalue()


@dataclass(frozen=True, slots=True)
class LaidOut:
    """The files of a model in a folder: the path of the bench, and the folder."""

    bench: Path
    root: Path

    def name_of(self, file: str) -> str:
        """Return the name by which a file is known in the model; of one that is elsewhere the path."""
        path = Path(file).resolve()
        return path.relative_to(self.root).as_posix() if path.is_relative_to(self.root) else file

    def read(self) -> Source:
        """Return the bench's data, with file and line of every value."""
        return read_source(self.bench)

    def where(self, model: ModelFiles, location: Location) -> tuple[str, Location, Any]:
        """Return file and keys of a location, and the value of the key that the bench inherits there, None if none."""
        document = self.read().document
        section = location[:2]
        file = document.place(section)[0] if section in document.places else str(self.bench)
        name = self.name_of(file)
        if (*section, NAMED) in document.places and name in model.texts:
            return name, location[2:], None
        if name == model.bench or len(location) < 3:
            return model.bench, location, None
        return model.bench, location, read_text(Path(file).read_text(encoding="utf-8"), file).at(section)


def _changed(text: str, location: Location, value: Any) -> str:
    return without(text, location) if value is None else with_value(text, location, value)
