"""What a recording needs of a bench; without the libraries that write it."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray


class RecordedBench(Protocol):
    """What a recording keeps of a bench."""

    @property
    def name(self) -> str:
        """Name of the bench."""

    @property
    def step_ns(self) -> int:
        """Length of a tick."""

    @property
    def parameter_row(self) -> NDArray[np.float64]:
        """Packed parameters."""

    @property
    def tables(self) -> NDArray[np.float64]:
        """Tables over the crank angle."""

    @property
    def state_row(self) -> NDArray[np.float64]:
        """Packed state before the first tick."""

    @property
    def sources(self) -> Mapping[str, str]:
        """Texts of the bench's files by their names."""
