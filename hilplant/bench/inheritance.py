"""`extends`: a bench file over another, section by section."""

from hilplant.bench.database import Database
from hilplant.checked_yaml.reading import Reading
from hilplant.checked_yaml.yaml_reader import Document, Location


def read_bases(reading: Reading, document: Document) -> Document:
    """Read what a bench file extends, and return it over that.

    Sections are joined key by key; a key that is given replaces the inherited one whole, so that a load or an
    interface does not keep arguments of the one that it replaces.
    """
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


def drop_strangers(reading: Reading, document: Document, database: Database) -> None:
    """Leave out inherited messages that a database does not have.

    Those of the ECU are simply not there then. Those of the plant would be missed: they are one problem.
    """
    for section in ("ecu", "bus"):
        for direction in ("receive", "send"):
            location = (section, direction)
            if document.place(location)[0] == document.file or not isinstance(document.at(location), dict):
                continue
            messages = document.at(location)
            strangers = database.missing(messages)
            document.replace(location, {key: inner for key, inner in messages.items() if key not in strangers})
            if strangers and section == "bus":
                _note_strangers(reading, document, direction, strangers)


def _note_strangers(reading: Reading, document: Document, direction: str, strangers: list[str]) -> None:
    base = document.place(("bus", direction))[0]
    shown = f"{', '.join(strangers[:3])}{' ...' if len(strangers) > 3 else ''}"
    text = f"{direction} is inherited from {base} and names {shown}, which this database has not"
    text += f"; give your own {direction}"
    reading.note(document, ("bus", "database"), text)


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
