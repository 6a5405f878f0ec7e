"""Records in shared memory on their way from one writer to any number of readers, each with a place of its own."""

from typing import Any, NamedTuple

import numpy as np

from hilplant.arrays import AnyArray


class Taken(NamedTuple):
    """What is new, the place behind it, and how much was overwritten before it was read."""

    records: AnyArray
    place: int
    lost: int


class Lane:
    """An array in shared memory that is written round and round; its head, a word beside it, counts all there were.

    The writer fills a slot, then moves the head. A reader copies, then looks at the head again: what may have been
    overwritten meanwhile is not given but counted.
    """

    def __init__(self, words: memoryview, head_at: int, records: AnyArray) -> None:
        """Find the lane whose head is the word `head_at`."""
        self._words, self._head_at, self._records = words, head_at, records

    @property
    def head(self) -> int:
        """How many records there have been."""
        return self._words[self._head_at]  # type: ignore[no-any-return]

    @property
    def capacity(self) -> int:
        """How many of them are kept."""
        return len(self._records)

    def append(self, *records: tuple[Any, ...]) -> None:
        """Write records; a reader sees all of them or none."""
        head = self.head
        for offset, record in enumerate(records):
            self._records[(head + offset) % len(self._records)] = record
        self._words[self._head_at] = head + len(records)

    def at(self, place: int) -> tuple[Any, ...]:
        """Return one record as a tuple."""
        return tuple(self._records[place % len(self._records)].item())

    def since(self, place: int) -> Taken:
        """Copy what has been written since there were `place` records."""
        count, head = len(self._records), self.head
        first = min(max(place, head - count + 1), head)
        copied = self._records[np.arange(first, head) % count]
        overwritten = max(0, self.head - count + 1 - first)
        return Taken(copied[overwritten:], head, max(first - place, 0) + min(overwritten, len(copied)))
