"""Generators of what an input does over time: waves, noise, repeated points, files, supply profiles.

In a scenario a generator stands in the place of a value, and drives the input until its next entry.
"""

import csv
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, model_validator

from hilplant.arrays import Floats
from hilplant.checked_yaml.checked import Checked, NotNegative, Positive, wrong
from hilplant.failure import Failure
from hilplant.simulation.supply_profiles import load_profile, rounds_of

#: Values at times [s] from the entry on.
Shape = Callable[[Floats], Floats]
Point = Annotated[list[float], Field(min_length=2, max_length=2)]


class Wave(Checked):
    """A periodic wave about a mean; the phase is in turns, 0 to 1."""

    mean: float = Field(default=0.0, description="its mean")
    amplitude: NotNegative = Field(description="half of peak to peak")
    hz: Positive = Field(description="its frequency [Hz]")
    phase: Annotated[float, Field(default=0.0, ge=0.0, le=1.0, description="where in its period it begins, 0 to 1")]

    def turns(self, times_s: Floats) -> Floats:
        """Return where in its period it is, 0 to below 1."""
        return np.asarray((times_s * self.hz + self.phase) % 1.0)


class Sine(Wave):
    """mean + amplitude sin(2 pi (f t + phase))."""

    def values(self, times_s: Floats) -> Floats:
        """Return the wave."""
        return np.asarray(self.mean + self.amplitude * np.sin(2.0 * np.pi * (times_s * self.hz + self.phase)))


class Triangle(Wave):
    """From the mean up to the top in a quarter of the period, down to the bottom, and back."""

    def values(self, times_s: Floats) -> Floats:
        """Return the wave."""
        quarter = (self.turns(times_s) + 0.25) % 1.0
        return np.asarray(self.mean + self.amplitude * (1.0 - 4.0 * np.abs(quarter - 0.5)))


class Square(Wave):
    """At the top for the part `duty` of the period, then at the bottom."""

    duty: Annotated[float, Field(default=0.5, gt=0.0, lt=1.0, description="part of the period at the top")]

    def values(self, times_s: Floats) -> Floats:
        """Return the wave."""
        return np.asarray(self.mean + np.where(self.turns(times_s) < self.duty, self.amplitude, -self.amplitude))


class Noise(Checked):
    """Normal white noise, a new number each tick, the same in every run."""

    mean: float = Field(default=0.0, description="its mean")
    deviation: NotNegative = Field(description="its standard deviation")
    seed: Annotated[int, Field(default=0, ge=0, description="where its random numbers begin")]

    def values(self, times_s: Floats) -> Floats:
        """Return the noise."""
        return self.mean + self.deviation * np.random.default_rng(self.seed).standard_normal(len(times_s))


class Repeat(Checked):
    """Points of time and value, straight between them, again and again."""

    points: Annotated[list[Point], Field(min_length=1, description="[TIME, VALUE] from the beginning of each round")]
    every: Positive = Field(description="length of a round [s]")
    times: Annotated[int | None, Field(default=None, ge=1, description="rounds; without end if left out")]
    step: bool = Field(default=False, description="hold each value until the next point instead")

    @model_validator(mode="after")
    def _rising(self) -> "Repeat":
        times = [time for time, _ in self.points]
        if any(later <= before for before, later in pairwise(times)) or times[0] < 0.0:
            raise wrong("points", text="points: times must rise from 0 on")
        if times[-1] > self.every:
            raise wrong("every", text=f"every: a round of {self.every:g} s ends before its last point")
        return self

    def values(self, times_s: Floats) -> Floats:
        """Return the points' values; after the last round the last one's."""
        at, value = (np.array(column) for column in zip(*self.points, strict=True))
        rounds, within = rounds_of(times_s, self.every)
        if self.times is not None:
            within = np.where(rounds >= self.times, self.every, within)
        if self.step:
            return np.asarray(value[np.maximum(np.searchsorted(at, within, side="right") - 1, 0)])
        return np.asarray(np.interp(within, at, value), dtype=np.float64)


class CsvColumn(Checked):
    """A column of a CSV file over its time column, straight between its rows; the last value holds."""

    file: Annotated[str, Field(min_length=1, description="CSV file with names in its first row, beside the scenario")]
    column: Annotated[str, Field(min_length=1, description="name of the column")]
    time: Annotated[str, Field(default="time_s", min_length=1, description="name of the time column [s]")]

    def shape(self, beside: Path) -> Shape:
        """Read the file.

        Raises
        ------
        Failure
            When it cannot be read, or names a row that is no number.

        """
        path = beside / self.file
        times, values = _two_columns(path, self.time, self.column)
        if not len(times) or (np.diff(times) <= 0.0).any():
            raise Failure(f"{path}: {self.time} must rise from row to row")
        return lambda wanted: np.interp(wanted, times, values)


def _two_columns(path: Path, *names: str) -> tuple[Floats, Floats]:
    columns: tuple[list[float], list[float]] = ([], [])
    line = 1
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = csv.DictReader(file)
            for name in names:
                if name not in (rows.fieldnames or ()):
                    raise Failure(f"{path}: no column '{name}'; it has {', '.join(rows.fieldnames or ())}")
            for row in rows:
                line = rows.line_num
                for column, name in zip(columns, names, strict=True):
                    number = float(row[name])
                    if not np.isfinite(number):
                        raise ValueError(number)
                    column.append(number)
    except (OSError, UnicodeDecodeError) as error:
        raise Failure(f"{path}: cannot be read ({getattr(error, 'strerror', None) or 'not UTF-8'})") from None
    except (ValueError, TypeError):
        raise Failure(f"{path}:{line}: {' and '.join(names)} must be finite numbers") from None
    return np.array(columns[0]), np.array(columns[1])


class Generated(Checked):
    """Exactly one generator."""

    sine: Sine | None = None
    triangle: Triangle | None = None
    square: Square | None = None
    noise: Noise | None = None
    repeat: Repeat | None = None
    csv: CsvColumn | None = None
    profile: Annotated[str | None, Field(default=None, min_length=1, description="a supply profile by name or file")]

    @model_validator(mode="after")
    def _one(self) -> "Generated":
        if len(self.model_fields_set) != 1:
            raise wrong(text=f"a generator is one of {', '.join(type(self).model_fields)}")
        return self

    def shape(self, beside: Path) -> Shape:
        """Return the values over time; `beside` is the folder of the scenario.

        Raises
        ------
        Failure
            When a file or a profile cannot be read.

        """
        (name,) = self.model_fields_set
        given: Any = getattr(self, name)
        if isinstance(given, CsvColumn):
            return given.shape(beside)
        shape: Shape = load_profile(given).values if isinstance(given, str) else given.values
        return shape


#: Keys by which a generator is told from a ramp.
GENERATORS = frozenset(Generated.model_fields)
