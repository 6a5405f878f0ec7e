"""Supply voltages over time, each a file of config/profiles with its source."""

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from hilplant import resources
from hilplant.arrays import Floats
from hilplant.checked_yaml.checked import Checked, NotNegative
from hilplant.checked_yaml.reading import Reading
from hilplant.units import SECOND_NS

#: Decimals of a nanosecond: sums of times are rounded to it, so that an edge comes in its own tick.
_DIGITS = 9


def rounds_of(times_s: Floats, length_s: float) -> tuple[Floats, Floats]:
    """Return how many rounds are over, and the time in the present one [s], exact to the nanosecond."""
    whole, rest = np.divmod(np.round(times_s * SECOND_NS), max(1.0, np.round(length_s * SECOND_NS)))
    return whole, rest / SECOND_NS


class Step(Checked):
    """A part of a profile: on its way to a voltage, then held there, perhaps with ripple about it."""

    to_v: float = Field(description="where it goes [V]")
    in_s: NotNegative = Field(default=0.0, description="how long that takes [s]")
    hold_s: NotNegative = Field(default=0.0, description="how long it stays [s]")
    ripple_v_pp: NotNegative = Field(default=0.0, description="peak to peak of a sine from its lowest point up [V]")
    ripple_hz: NotNegative = Field(default=0.0, description="its frequency [Hz]")

    def held(self, times_s: Floats) -> Floats:
        """Return the voltage while it stays, by the time since it came."""
        return np.asarray(self.to_v - 0.5 * self.ripple_v_pp * np.cos(2.0 * np.pi * self.ripple_hz * times_s))


class SupplyProfile(Checked):
    """A supply voltage over time: steps from `start_v`, repeated; a file of config/profiles."""

    title: str = Field(description="what it stands for")
    source: str = Field(description="where its figures come from")
    status: Literal["published", "assumed"] = Field(description="published: read in a source; assumed: not checked")
    cannot_show: str = Field(default="", description="what a plant with a step of 1 ms cannot show of it")
    start_v: float = Field(description="voltage before the first step [V]")
    times: Annotated[int, Field(default=1, ge=1, description="how often the steps are gone through")]
    pause_s: NotNegative = Field(default=0.0, description="at the last voltage between two rounds [s]")
    steps: Annotated[list[Step], Field(min_length=1)]

    @property
    def round_s(self) -> float:
        """Length of a round, the pause after it included [s]."""
        return sum(step.in_s + step.hold_s for step in self.steps) + self.pause_s

    @property
    def seconds(self) -> float:
        """Length of all rounds; the last one has no pause [s]."""
        return self.times * self.round_s - self.pause_s

    def values(self, times_s: Floats) -> Floats:
        """Return the voltage [V] at times from the profile's beginning; the last one holds."""
        last = self.steps[-1].to_v
        rounds, within = rounds_of(times_s, self.round_s)
        volts = np.full(len(times_s), last)
        begin, before = 0.0, np.where(rounds > 0.0, last, self.start_v)
        for step in self.steps:
            arrived = round(begin + step.in_s, _DIGITS)
            left = round(arrived + step.hold_s, _DIGITS)
            moving = (within >= begin) & (within < arrived)
            part = (within - begin) / step.in_s if step.in_s else within
            volts = np.where(moving, before + (step.to_v - before) * part, volts)
            held = (within >= arrived) & (within < left)
            volts = np.where(held, step.held(within - arrived), volts)
            begin, before = left, step.held(np.full(len(times_s), step.hold_s))
        return np.where(rounds >= self.times, last, volts)


def load_profile(name: str | Path) -> SupplyProfile:
    """Read a supply profile, by its path or by the name of a shipped one.

    Raises
    ------
    Failure
        BenchError with every problem, or when there is none of that name.

    """
    reading = Reading()
    document = reading.named_file(resources.named("profiles", name))
    profile = reading.take(document, (), SupplyProfile) if not document.problems else None
    reading.raise_problems()
    if profile is None:
        raise AssertionError("a profile that failed left no problem behind")
    return profile
