"""Why the park contact is compared as stairs, section 5.2: errors of pulses and stairs, Figures 5-2 and 5-3."""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.measurements.measurement import Measurement
from hilplant.measurements.park import rising_edges, staircase

#: Cases of Figure 5-2: how much slower the simulated wiper is; the last one does not move.
SLOWER = {"a": 0.02, "b": 0.20}
NEVER = "c"


class ParkCase(NamedTuple):
    """A simulated contact beside the measured one: pulses, stairs, and the mean size of both errors."""

    name: str
    pulses: Floats
    stairs: Floats
    pulse_error: float
    stair_error: float


def park_cases(data: Measurement) -> list[ParkCase]:
    """Return the measured contact as models would give it that are a little slow, slow, and at rest.

    Raises
    ------
    Failure
        When the contact of the measurement closes less than twice.

    """
    if len(rising_edges(data.park)) < 2:
        raise Failure(f"{data.source}: the park contact closes less than twice; record some turns")
    contacts = {name: _slowed(data, share) for name, share in SLOWER.items()} | {NEVER: np.zeros(len(data))}
    measured = staircase(data.park)
    found = []
    for name, pulses in contacts.items():
        stairs = staircase(pulses)
        errors = float(np.abs(pulses - data.park).mean()), float(np.abs(stairs - measured).mean())
        found.append(ParkCase(name, pulses, stairs, *errors))
    return found


def _slowed(data: Measurement, share: float) -> Floats:
    """Return the contact of a wiper that turns by a share more slowly from the first closing on."""
    first = data.time_s[rising_edges(data.park)[0]]
    earlier = np.where(data.time_s > first, first + (data.time_s - first) * (1.0 - share), data.time_s)
    places = np.clip(np.round(earlier / data.period_s).astype(int), 0, len(data) - 1)
    return np.asarray(data.park[places], dtype=np.float64)
