"""What a recorded run came to: wipes, rates, currents, and where the wiper stopped."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from hilplant.arrays import AnyArray
from hilplant.units import RAD_PER_DEG, TURN_RAD

#: What the figures are made of, by the names that :func:`hilplant.recording.export.signal_columns` gives.
COLUMNS = (
    "time_s",
    "in_relay_on",
    "in_relay_fast",
    "crank_angle_rad",
    "crank_speed_rad_s",
    "current_a",
    "park_contact",
)

#: A speed counts as steady this long [s] after the relays last changed.
_SETTLED_S = 0.5


class Stop(NamedTuple):
    """Where the crank came to rest after the supply was taken away."""

    time_s: float
    angle_deg: float  # from park, negative short of it
    in_park: bool


class SpeedFigures(NamedTuple):
    """One speed of the motor: settled cycles a minute, mean and peak current [A]; nan if it never ran."""

    cycles_per_min: float
    mean_current_a: float
    peak_current_a: float


class Figures(NamedTuple):
    """The summary of a run."""

    wipes: int
    slow: SpeedFigures
    fast: SpeedFigures
    stops: tuple[Stop, ...]


def figures(columns: Mapping[str, AnyArray]) -> Figures:
    """Condense a recording; `columns` are those of :data:`COLUMNS`, one value a tick, without gaps."""
    on = columns["in_relay_on"] > 0.5
    fast = columns["in_relay_fast"] > 0.5
    angle_rad = np.unwrap(columns["crank_angle_rad"])
    return Figures(
        _wipes(angle_rad),
        _speed(columns, on & ~fast),
        _speed(columns, on & fast),
        _stops(columns, on),
    )


def _wipes(angle_rad: AnyArray) -> int:
    """Count the turns begun since the start; a turn that ends within the park window is one, not the next."""
    turns = float(angle_rad[-1] - angle_rad[0]) / TURN_RAD if len(angle_rad) else 0.0
    return round(turns)


def _speed(columns: Mapping[str, AnyArray], driven: AnyArray) -> SpeedFigures:
    if not driven.any():
        return SpeedFigures(np.nan, np.nan, np.nan)
    time_s = columns["time_s"]
    begins = np.maximum.accumulate(np.where(driven, time_s[0], time_s))
    settled = driven & (time_s - begins > _SETTLED_S)
    speed = columns["crank_speed_rad_s"][settled]
    current_a = columns["current_a"]
    rate = float(speed.mean()) / TURN_RAD * 60.0 if len(speed) else np.nan
    mean_a = float(current_a[settled].mean()) if len(speed) else np.nan
    return SpeedFigures(rate, mean_a, float(current_a[driven].max()))


def _stops(columns: Mapping[str, AnyArray], on: AnyArray) -> tuple[Stop, ...]:
    """Look at the last tick before each new start, and at the last of all."""
    released = np.flatnonzero(on[:-1] & ~on[1:]) + 1
    stops = []
    for first in released:
        again = np.flatnonzero(on[first:])
        last = first + again[0] - 1 if len(again) else len(on) - 1
        angle_deg = float(columns["crank_angle_rad"][last]) / RAD_PER_DEG
        in_park = bool(columns["park_contact"][last] > 0.5)
        stops.append(Stop(float(columns["time_s"][first]), (angle_deg + 180.0) % 360.0 - 180.0, in_park))
    return tuple(stops)
