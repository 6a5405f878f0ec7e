"""What a recording needs of a bench; without the libraries that write it."""

from collections.abc import Mapping
from typing import Protocol

from hilplant.arrays import Floats


class RecordedBench(Protocol):
    """What a recording keeps of a bench."""

    @property
    def name(self) -> str:
        """Name of the bench."""

    @property
    def step_ns(self) -> int:
        """Length of a tick."""

    @property
    def pace(self) -> float:
        """Seconds of the plant in a second of the clock."""

    @property
    def parameter_row(self) -> Floats:
        """Packed parameters."""

    @property
    def tables(self) -> Floats:
        """Tables over the crank angle."""

    @property
    def state_row(self) -> Floats:
        """Packed state before the first tick."""

    @property
    def sources(self) -> Mapping[str, str]:
        """Texts of the bench's files by their names."""
