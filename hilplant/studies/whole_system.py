"""The test of section 4.6: five wipes of one second at even speed, with another screen or wind in each."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilplant.bench.assembly import Bench
from hilplant.models.tables import LEFT_ROCKER
from hilplant.studies.crank_torque import WETNESS, Conditions, crank_torque
from hilplant.units import TURN_RAD

Floats = NDArray[np.float64]

#: The crank turns once a second.
CRANK_SPEED_RAD_S = TURN_RAD
SAMPLES = 500

_WET, _DRY = WETNESS["wet"], WETNESS["dry"]
#: Conditions of the five seconds.
WIPES = (
    Conditions(_WET),
    Conditions(_WET, 20.0),
    Conditions(_WET, 40.0),
    Conditions(_WET),
    Conditions(_DRY),
)


@dataclass(frozen=True, slots=True)
class Wipe:
    """One second of the test: its torques at the crank [N m], and which of them belong to the forward wipe."""

    conditions: Conditions
    crank_rad: Floats
    torque_n_m: Floats
    forward: NDArray[np.bool_]

    @property
    def mean_n_m(self) -> float:
        """Mean torque over the wipe."""
        return float(self.torque_n_m.mean())

    @property
    def forward_n_m(self) -> float:
        """Mean torque of the forward wipe."""
        return float(self.torque_n_m[self.forward].mean())

    @property
    def reverse_n_m(self) -> float:
        """Mean torque of the reverse wipe."""
        return float(self.torque_n_m[~self.forward].mean())


def five_wipes(bench: Bench) -> list[Wipe]:
    """Return the five wipes of Figure 4-32 with this bench's wiper."""
    crank = np.linspace(0.0, TURN_RAD, SAMPLES, endpoint=False)
    forward = _forward(bench, crank)
    return [
        Wipe(conditions, crank, crank_torque(bench, crank, CRANK_SPEED_RAD_S, conditions), forward)
        for conditions in WIPES
    ]


def shape_difference(one: Wipe, other: Wipe) -> float:
    """Return how far the shapes of two wipes are apart: the RMS difference of their torques, each over its mean."""
    apart = one.torque_n_m / one.mean_n_m - other.torque_n_m / other.mean_n_m
    return float(np.sqrt(np.mean(apart**2)))


def _forward(bench: Bench, crank_rad: Floats) -> NDArray[np.bool_]:
    """Say at which angles the left arm is on its way from park to the other end of its sweep."""
    rocker = bench.tables[:-1, LEFT_ROCKER, 0]
    far = np.argmax(np.abs(rocker - rocker[0])) * TURN_RAD / len(rocker)
    return np.asarray(crank_rad < far)
