"""The test of section 4.6: five wipes of one second at even speed, with another screen or wind in each."""

from dataclasses import dataclass, replace

import numpy as np

from hilplant.arrays import Flags, Floats
from hilplant.bench.assembly import Bench
from hilplant.models.tables import LEFT_ROCKER
from hilplant.simulation.crank_torque import WETNESS, Conditions, crank_torque
from hilplant.units import TURN_RAD

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
    """One second of the test: its torques at the crank [N m], and which of them belong to the forward wipe.

    `friction_n_m` is what of each torque is friction: the rest is there with lifted arms as well.
    """

    conditions: Conditions
    crank_rad: Floats
    torque_n_m: Floats
    friction_n_m: Floats
    forward: Flags

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
    return [_wipe(bench, crank, forward, conditions) for conditions in WIPES]


def _wipe(bench: Bench, crank_rad: Floats, forward: Flags, conditions: Conditions) -> Wipe:
    whole, lifted = (
        crank_torque(bench, crank_rad, CRANK_SPEED_RAD_S, each)
        for each in (conditions, replace(conditions, pressed=0.0))
    )
    return Wipe(conditions, crank_rad, whole, whole - lifted, forward)


def shape_difference(one: Wipe, other: Wipe) -> float:
    """Return how far two wipes are apart in the shape of their friction: RMS difference, each over its mean.

    Masses and gravity are left out: they are the same in both, and on a wet screen as large as the friction, so that
    the whole torque over its mean would show their share and not a shape. 0 where nothing rubs.
    """
    if not one.friction_n_m.any() or not other.friction_n_m.any():
        return 0.0
    apart = one.friction_n_m / one.friction_n_m.mean() - other.friction_n_m / other.friction_n_m.mean()
    return float(np.sqrt(np.mean(apart**2)))


def _forward(bench: Bench, crank_rad: Floats) -> Flags:
    """Say at which angles the left arm is on its way from park to the other end of its sweep."""
    rocker = bench.tables[:-1, LEFT_ROCKER, 0]
    far = np.argmax(np.abs(rocker - rocker[0])) * TURN_RAD / len(rocker)
    return np.asarray(crank_rad < far)
