"""What a part of the benchmarks returns: rows for the table, figures for the JSON file, remarks."""

from dataclasses import dataclass, field
from typing import NamedTuple

from hilplant.failure import Failure


class NotMeasurable(Failure):
    """This machine cannot give the figure; the text says why, and what would fix it."""


class Goal(NamedTuple):
    """What a figure should not exceed: its ratio to the limit, or its value."""

    at_most: float
    of_ratio: bool = True


class Row(NamedTuple):
    """One figure beside its limit, both from the same run and in the same unit."""

    what: str
    value: float
    unit: str
    limit: float | None = None
    limit_name: str = ""
    goal: Goal | None = None

    @property
    def ratio(self) -> float | None:
        """How many times the limit the figure is."""
        return self.value / self.limit if self.limit else None

    @property
    def met(self) -> bool | None:
        """Whether the goal is reached; None where there is none."""
        judged = self.ratio if self.goal is not None and self.goal.of_ratio else self.value
        if self.goal is None or judged is None:
            return None
        return judged <= self.goal.at_most


@dataclass(slots=True)
class PartResult:
    """What one part came to."""

    rows: list[Row] = field(default_factory=list)
    figures: dict[str, float | str] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)
