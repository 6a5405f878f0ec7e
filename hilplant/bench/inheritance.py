"""`extends`: a bench file over another, section by section."""

from pathlib import Path

from hilplant.checked_yaml.reading import Reading
from hilplant.checked_yaml.yaml_reader import Document, Location


def read_bench_file(reading: Reading, path: Path) -> Document:
    """Read a bench file and what it extends.

    Sections are joined key by key; a key that is given replaces the inherited one whole, so that a load or an
    interface does not keep arguments of the one that it replaces.
    """
    document = reading.named_file(path)
    seen = {document.file}
    while isinstance(document.data, dict) and isinstance(document.data.get("extends"), str):
        base = reading.referred_file(document, ("extends",))
        if base is None:
            return Document(document.file)  # without its base nothing more can be said of it
        if base.file in seen:
            reading.note(document, ("extends",), f"{base.file} extends itself in the end")
            return Document(document.file)
        seen.add(base.file)
        document = _joined(base, document)
    return document


def _joined(base: Document, over: Document) -> Document:
    """Return `over` with what it leaves out taken from `base`; `extends` is then the base's, if any."""
    if not isinstance(base.data, dict):
        return over
    data = dict(base.data)
    replaced: set[Location] = {("extends",)}
    for key, value in over.data.items():
        inherited = data.get(key)
        if isinstance(value, dict) and isinstance(inherited, dict):
            data[key] = inherited | value
            replaced |= {(key, inner) for inner in value}
        elif key != "extends":
            data[key] = value
            replaced.add((key,))
    places = {
        location: place
        for location, place in base.places.items()
        if location == ("extends",) or (location[:1] not in replaced and location[:2] not in replaced)
    }
    own = {location: place for location, place in over.places.items() if location != ("extends",)}
    return Document(over.file, data, places | own)
