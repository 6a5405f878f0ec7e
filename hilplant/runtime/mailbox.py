"""The mailbox: commands on their way into the loop, in shared memory, bounded; one writer, read at a tick's start."""

from collections.abc import Sequence

from hilplant.runtime.commands import ChannelCommand
from hilplant.runtime.lane import Lane

#: Most commands that a tick takes; the others wait for the next. A group of commands is never parted.
MOST_A_TICK = 32


class Mailbox:
    """A lane of commands, and a word that says how many of them the loop has taken."""

    def __init__(self, words: memoryview, tail_at: int, lane: Lane) -> None:
        """Find the mailbox in the ring's memory."""
        self._words, self._tail_at, self._lane = words, tail_at, lane

    def post(self, commands: Sequence[ChannelCommand]) -> bool:
        """Leave commands that are taken in one tick; False, and none is left, when there is no room for all.

        Raises
        ------
        ValueError
            When they are more than a tick takes.
        """
        if len(commands) > MOST_A_TICK:
            raise ValueError(f"at most {MOST_A_TICK} commands belong to one tick, not {len(commands)}")
        taken: int = self._words[self._tail_at]
        if self._lane.head - taken + len(commands) > self._lane.capacity:
            return False
        last = len(commands) - 1
        self._lane.append(*(each._replace(more=int(place < last)) for place, each in enumerate(commands)))
        return True

    @property
    def waiting(self) -> bool:
        """Whether there is anything to take; asked in each tick."""
        return self._lane.head != self._words[self._tail_at]

    def take(self) -> list[ChannelCommand]:
        """Take what has come, as the loop."""
        place: int = self._words[self._tail_at]
        head = self._lane.head
        taken: list[ChannelCommand] = []
        while place < head and (len(taken) < MOST_A_TICK or taken[-1].more):
            taken.append(ChannelCommand(*self._lane.at(place)))
            place += 1
        self._words[self._tail_at] = place
        return taken
