"""When a fault comes and goes: at a time or on a condition, for how long, how likely, at once or little by little."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from random import Random

from hilplant.faults.fault import NOTHING, About, FaultDefinition
from hilplant.verdicts.expectations import Condition
from hilplant.verdicts.ticks import margin

Row = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Inserted:
    """A fault with its values and its times; times in ticks from the first one.

    From `at` on it waits for `when`, on the signals of the tick before; then it lasts for `ticks` (None: to the end).
    It grows to its full size in `ramp` ticks. Where `pause` is not 0 it is intermittent: on for `ticks`, off for
    `pause`, again and again. Each time that it would come it does with `probability`.
    """

    fault: FaultDefinition
    values: Mapping[str, float]
    at: int = 0
    ticks: int | None = None
    when: Condition = ()
    probability: float = 1.0
    seed: int = 0
    ramp: int = 0
    pause: int = 0
    place: str = field(default="", compare=False)
    about: About = NOTHING


class Course:
    """One inserted fault as time goes on; `level` is how far it is there, 0 to 1."""

    def __init__(self, inserted: Inserted) -> None:
        self.inserted = inserted
        self.level = 0.0
        self._random = Random(inserted.seed)
        self._begin: int | None = None
        self._before: Row | None = None
        self._drawn = -1
        self._comes = False
        self._ended = False

    @property
    def waiting(self) -> bool:
        """Whether it waits for a condition, so that every tick has to be looked at."""
        return bool(self.inserted.when) and self._begin is None and not self._ended

    @property
    def over(self) -> bool:
        """Whether it is gone and will not come again."""
        return self._ended or (not self.inserted.pause and self._begin is not None and self.level == 0.0)

    def end(self) -> None:
        """Let it go, and not come again."""
        self._ended = True

    def move(self, tick: int, row: Row | None) -> None:
        """Go on to `tick`; `row` are the signals of the tick before, None where nobody needs them."""
        if self._begin is None and tick >= self.inserted.at and self._met(row):
            self._begin = tick
        self._before = row
        self.level = 0.0 if self._begin is None or self._ended else self._at(tick - self._begin)

    def next_change(self, tick: int) -> float:
        """Return the next tick after `tick` at which the level may be another; endless where none is."""
        inserted = self.inserted
        if self._ended:
            return tick + 1 if self.level else math.inf
        if self._begin is None:
            return max(inserted.at, tick + 1)
        elapsed, length = tick - self._begin, inserted.ticks
        if inserted.pause and length is not None:
            cycle = length + inserted.pause
            within = elapsed % cycle
            if within < inserted.ramp:
                return tick + 1
            return tick + (length - within if within < length else cycle - within)
        if elapsed < inserted.ramp:
            return tick + 1
        return self._begin + length if length is not None and elapsed < length else math.inf

    def _met(self, row: Row | None) -> bool:
        if not self.inserted.when:
            return True
        return row is not None and margin(self.inserted.when, row, self._before) >= 0.0

    def _at(self, elapsed: int) -> float:
        inserted, cycle = self.inserted, 0
        if inserted.pause and inserted.ticks is not None:
            cycle, elapsed = divmod(elapsed, inserted.ticks + inserted.pause)
        if inserted.ticks is not None and elapsed >= inserted.ticks:
            return 0.0
        while self._drawn < cycle:
            self._drawn += 1
            self._comes = self._random.random() < inserted.probability
        if not self._comes:
            return 0.0
        return min(1.0, (elapsed + 1) / inserted.ramp) if inserted.ramp else 1.0
