"""Plays inserted faults into a row of parameters, tick by tick; where none is present the row is as it was built."""

import math
from collections.abc import Sequence

import numpy as np

from hilplant.arrays import Floats
from hilplant.declaration import Signal
from hilplant.faults.fault import Change
from hilplant.faults.timing import Course, Inserted, Row
from hilplant.models.records import PARAMETER_INDEX

#: Groups of elements that are looked at only where their first element, `altered`, is 1.
_SWITCHED = ("wiring", "relays", "sensors", "heat", "obstacles", "linkage")


class FaultPlayer:
    """The faults of one run.

    `base_row` are the packed parameters without faults, `step_s` the length of a tick [s].
    """

    def __init__(self, inserted: Sequence[Inserted], base_row: Floats, step_s: float) -> None:
        self.courses = [Course(each) for each in inserted]
        self._base = base_row.copy()
        self._step_s = step_s
        self._levels: tuple[float, ...] = (0.0,) * len(self.courses)

    def add(self, course: Course) -> None:
        """Insert one more; its times count from the first tick of the run."""
        self.courses.append(course)
        self._levels += (0.0,)

    def remove(self, course: Course) -> None:
        """Take one out that is over, and whose changes have been taken back."""
        place = self.courses.index(course)
        del self.courses[place]
        self._levels = self._levels[:place] + self._levels[place + 1 :]

    def rebase(self, index: int, value: float) -> float:
        """Change an element of the row without faults; returns its value with them."""
        self._base[index] = value
        return self._value(index)

    @property
    def present(self) -> tuple[str, ...]:
        """Names of the faults that are there now."""
        return tuple(course.inserted.fault.name for course in self.courses if course.level > 0.0)

    @property
    def watches(self) -> bool:
        """Whether some fault waits for a condition, so that :meth:`changes` needs the signals."""
        return any(course.waiting for course in self.courses)

    def next_change(self, tick: int) -> float:
        """Return the next tick at which something may change; endless where nothing will."""
        return min((course.next_change(tick) for course in self.courses), default=math.inf)

    def changes(self, tick: int, row: Row | None = None) -> dict[int, float]:
        """Go on to `tick` and return the elements that change then, by index, with their new values.

        `row` are the signals of the tick before by their names.
        """
        for course in self.courses:
            course.move(tick, row)
        levels = tuple(course.level for course in self.courses)
        if levels == self._levels:
            return {}
        before, self._levels = self._touched(self._levels), levels
        return {index: self._value(index) for index in before | self._touched(levels)}

    def _touched(self, levels: tuple[float, ...]) -> set[int]:
        touched: set[int] = set()
        for course, level in zip(self.courses, levels, strict=True):
            if level > 0.0:
                elements = [change.element for change in course.inserted.fault.changes]
                switched = [f"{name.partition('.')[0]}.altered" for name in elements if name.startswith(_SWITCHED)]
                touched.update(PARAMETER_INDEX[name] for name in elements + switched)
        return touched

    def _value(self, index: int) -> float:
        value, name = float(self._base[index]), _NAMES[index]
        for course in self.courses:
            if course.level <= 0.0:
                continue
            for change in course.inserted.fault.changes:
                if change.element == name:
                    value = self._met(value, change, course)
                elif name.endswith(".altered") and change.element.startswith(name.removesuffix("altered")):
                    value = 1.0
        return value

    def _met(self, value: float, change: Change, course: Course) -> float:
        number, level = change.value(course.inserted.values, self._step_s), course.level
        if change.way == "add":
            return value + level * number
        return value * (1.0 + (number - 1.0) * level) if change.way == "scale" else number


_NAMES = {index: name for name, index in PARAMETER_INDEX.items()}


def signal_row(signals: Sequence[Signal], values: Floats) -> dict[str, float]:
    """Return values by the names of their signals."""
    return dict(zip((signal.name for signal in signals), np.asarray(values).tolist(), strict=True))
