"""How far the table is from the truth between its knots, and how many knots keep it within a bound."""

from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.mechanics.tables import channel_names, exact_rows, run_time_table
from hilplant.mechanics.wiper import Wiper
from hilplant.models.lookup import derivative, find, value
from hilplant.units import TURN_RAD

#: Where within an interval a cubic Hermite is farthest off: the value in the middle, the derivative beside it.
WORST = (0.5, 0.5 - np.sqrt(3.0) / 6.0, 0.5 + np.sqrt(3.0) / 6.0)
#: Knots that are tried, each twice the one before.
FEWEST, MOST = 32, 16384


@dataclass(frozen=True, slots=True)
class ChannelError:
    """Largest errors of one channel between the knots, and the largest values that it has."""

    name: str
    value_error: float
    slope_error: float
    largest_value: float
    largest_slope: float

    @property
    def relative_error(self) -> float:
        """The greater of both errors, each by the largest value; 0 for a channel that is zero throughout."""
        pairs = ((self.value_error, self.largest_value), (self.slope_error, self.largest_slope))
        return max(error / largest if largest > 0.0 else error for error, largest in pairs)


def interpolation_errors(wiper: Wiper, knots: int) -> list[ChannelError]:
    """Compare what the step reads with positions solved for themselves, three in each interval."""
    table = run_time_table(wiper, knots)
    crank_rad = ((np.arange(knots)[:, np.newaxis] + np.array(WORST)) * (TURN_RAD / knots)).ravel()
    truth = exact_rows(wiper, crank_rad)
    errors = np.abs(read_rows(table, crank_rad) - truth).max(axis=0)
    largest = np.abs(truth).max(axis=0)
    names = channel_names(len(wiper.left.friction))
    return [
        ChannelError(name, *map(float, (error[0], error[1], size[0], size[1])))
        for name, error, size in zip(names, errors, largest, strict=True)
    ]


def read_rows(table: Floats, crank_rad: Floats) -> Floats:
    """Return all channels as the step reads them at crank angles in [0, 2 pi), [m, channels, 2]."""
    places = [find(table, angle) for angle in crank_rad]
    numbers = range(table.shape[1])
    return np.array(
        [[(value(table, index, number), derivative(table, index, number)) for number in numbers] for index in places]
    )


def knots_within(wiper: Wiper, relative_bound: float) -> int:
    """Return the fewest knots, a power of two, that keep all channels and their derivatives within a bound.

    Raises
    ------
    Failure
        When even the most knots do not.

    """
    knots = FEWEST
    while knots <= MOST:
        if max(error.relative_error for error in interpolation_errors(wiper, knots)) <= relative_bound:
            return knots
        knots *= 2
    raise Failure(f"no table of up to {MOST} knots keeps within {relative_bound:g} of the exact values")
