"""What expectations may name: signals, messages and marks."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class KnownSignal:
    """What is known of a signal: its unit, whether it has few values only, and the numbers of its labels."""

    unit: str = ""
    discrete: bool = False
    labels: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class KnownMessage:
    """What is known of a message: its cycle [ms], 0 where the database states none, and whether it is protected."""

    cycle_ms: float = 0.0
    protected: bool = False


@dataclass(frozen=True, slots=True)
class Known:
    """All that expectations may name, and the length of a tick and of the run [s]."""

    step_s: float
    seconds: float
    signals: Mapping[str, KnownSignal]
    messages: Mapping[str, KnownMessage]
    marks: Mapping[str, float] = field(default_factory=dict)

    def ticks(self, seconds: float) -> int:
        """Return how many ticks a time takes, the last one begun."""
        return math.ceil(seconds / self.step_s - 1e-6)
