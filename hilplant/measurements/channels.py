"""The channels of a file by their names, and what is to be known of how they were read."""

from collections.abc import Mapping, Sequence

from hilplant.measurements.measurement import Channel


class Channels(dict[str, Channel]):
    """Channels by name; `notes` say what of the file was skipped, cut off or put in order.

    `texts` are columns that are no channels because they hold text, with what stands in their first row.
    """

    def __init__(
        self, channels: Mapping[str, Channel], notes: Sequence[str] = (), texts: Mapping[str, str] | None = None
    ) -> None:
        super().__init__(channels)
        self.notes, self.texts = tuple(notes), dict(texts or {})
