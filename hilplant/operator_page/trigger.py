"""When a log begins: by hand, or at the first tick in which a signal meets a level, an edge or a condition."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from hilplant.arrays import Flags, Floats
from hilplant.channel.run_files import column_of
from hilplant.failure import Failure

Way = Literal["now", "above", "below", "rises", "falls", "equals", "changes"]


@dataclass
class Trigger:
    """`above` and `below` are levels, `rises` and `falls` edges through a level, `equals` and `changes` conditions."""

    way: Way = "now"
    signal: str = ""
    level: float = 0.0

    def __post_init__(self) -> None:
        """Check it.

        Raises
        ------
        Failure
            When there is no such way or signal.
        """
        if self.way not in get_args(Way):
            raise Failure(f"a trigger is one of {', '.join(get_args(Way))}")
        if not np.isfinite(self.level):
            raise Failure("the trigger's level is a number")
        self._place = column_of(self.signal) if self.way != "now" else 0
        self._before: float | None = None

    def first(self, rows: Floats) -> int | None:
        """Return the first of these rows [n, width] that meets it, None when none does; rows come in their order."""
        if not len(rows):
            return None
        values = rows[:, self._place]
        before = np.r_[values[0] if self._before is None else self._before, values[:-1]]
        self._before = float(values[-1])
        met = np.flatnonzero(self._met(values, before))
        return int(met[0]) if len(met) else None

    def _met(self, values: Floats, before: Floats) -> Flags:
        level = self.level
        found: dict[str, Flags] = {
            "now": np.full(len(values), True),
            "above": values > level,
            "below": values < level,
            "rises": (before <= level) & (values > level),
            "falls": (before >= level) & (values < level),
            "equals": values == level,
            "changes": values != before,
        }
        return found[self.way]
