"""What a measurement is once it is read: voltage, current and park switch on one clock, and how it came about."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Flags, Floats


@dataclass(frozen=True, slots=True)
class Channel:
    """One channel as its file has it, on its own clock.

    `unit` is what the file says, "" where it says nothing. A `held` channel keeps its value until the next sample,
    as a signal does that is sent when it changes; others are straight lines between samples.
    """

    time_s: Floats
    values: Floats
    unit: str = ""
    held: bool = False


class DataFinding(NamedTuple):
    """One thing that is wrong with a measurement: a name for programs, and a sentence for people.

    A `fatal` one makes identification pointless or wrong; another one is to be known.
    """

    name: str
    text: str
    fatal: bool = True


class Native(NamedTuple):
    """How a channel was sampled before it came onto the common clock."""

    period_s: float
    samples: int
    missing: int
    longest_gap_s: float


@dataclass(frozen=True, slots=True)
class Measurement:
    """Samples of equal distance `period_s` from one source.

    `voltage_v` is at the motor's terminals: 0 while the relay is off. `park` is 1 while the park contact is closed,
    after bouncing; `fast` is 1 in the fast mode, 0 in the slow one, NaN where nobody knows. `valid` is false where a
    sample of voltage or current is missing or an outlier: its value stays as it was recorded, or is a straight line
    over a gap.
    `notes` say what was done to the data, in the order in which it was done.
    """

    time_s: Floats
    voltage_v: Floats
    current_a: Floats
    park: Floats
    fast: Floats
    valid: Flags
    period_s: float
    source: str = ""
    sha256: str = ""
    native: tuple[tuple[str, Native], ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def park_steps(self) -> Floats:
        """The staircase of 5.2: how many times the park contact has closed up to each sample."""
        from hilplant.measurements.park import staircase

        return staircase(self.park)

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.time_s)


def running(data: Measurement) -> Flags:
    """Say where the motor is on: the terminal voltage above a tenth of its highest."""
    return np.asarray(np.abs(data.voltage_v) > 0.1 * float(np.max(np.abs(data.voltage_v))), dtype=np.bool_)
