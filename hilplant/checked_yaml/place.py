"""A spot in a bench file, with what is needed to check what stands there and to complain about it."""

from dataclasses import dataclass

from hilplant.checked_yaml.reading import Description, Reading
from hilplant.checked_yaml.yaml_reader import Document, Location


@dataclass(frozen=True, slots=True)
class Place:
    """One group of keys in a file that is being read."""

    reading: Reading
    document: Document
    location: Location

    @property
    def name(self) -> str:
        """The key under which the group stands."""
        return str(self.location[-1])

    def inner(self, *keys: str | int) -> "Place":
        """Return a place within this one."""
        return Place(self.reading, self.document, (*self.location, *keys))

    def data(self) -> object:
        """Return what stands here, None when it is nothing."""
        return self.document.at(self.location)

    def take(self, model: type[Description]) -> Description | None:
        """Check what stands here against its description; None when something is wrong with it."""
        return self.reading.take(self.document, self.location, model)

    def referred_file(self) -> "Place | None":
        """Return the whole of the YAML file that is named here; None when it cannot be read."""
        document = self.reading.referred_file(self.document, self.location)
        return Place(self.reading, document, ()) if document is not None else None

    def note(self, *inner: str | int, text: str) -> None:
        """Keep a problem at a key within this place."""
        self.reading.note(self.document, (*self.location, *inner), text)
