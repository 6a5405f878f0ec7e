"""The parameters that identification may find, by name: those of (5.1), and some beside them.

A parameter is one place in the packed row of ``models/records.py``. Others may be linked to it: they keep their ratio
to it, as mu_dry_4 = 10 mu_dry_3 (Tables 4-1, 4-2), or as one force on both blades.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.models.records import PARAMETER_INDEX

#: (5.22): the search goes from half to twice of what is known; for inductances, which stage 1 tells badly, from a
#: quarter to four times, and for friction too, whose published sets (Tables 4-1, 4-2, 5-8) differ as much.
FACTOR, WIDE_FACTOR = 2.0, 4.0


class CoupledParameter(NamedTuple):
    """A place in the row that keeps its ratio to a parameter; `ratio` where the bench has no value to take it from."""

    name: str
    place: int
    ratio: float


class Parameter(NamedTuple):
    """One parameter: where it is in the row, and how far the search goes.

    `usual` is its size where the bench has 0. `signed` allows negative values.
    """

    name: str
    unit: str
    place: int
    factor: float
    usual: float
    links: tuple[CoupledParameter, ...] = ()
    highest: float = np.inf
    signed: bool = False


_MOTOR_AT = {name.removeprefix("motor."): place for name, place in PARAMETER_INDEX.items()}
_FRICTION_AT = {name.removeprefix("load.friction."): place for name, place in PARAMETER_INDEX.items()}

_MOTOR = (
    Parameter("slow_resistance_ohm", "ohm", _MOTOR_AT["slow.resistance_ohm"], FACTOR, 1.2),
    Parameter("fast_resistance_ohm", "ohm", _MOTOR_AT["fast.resistance_ohm"], FACTOR, 1.0),
    Parameter("slow_inductance_henry", "H", _MOTOR_AT["slow.inductance_henry"], WIDE_FACTOR, 3e-3),
    Parameter("fast_inductance_henry", "H", _MOTOR_AT["fast.inductance_henry"], WIDE_FACTOR, 3e-3),
    Parameter("slow_constant_v_s", "V s/rad", _MOTOR_AT["slow.constant_v_s"], FACTOR, 0.045),
    Parameter("fast_constant_v_s", "V s/rad", _MOTOR_AT["fast.constant_v_s"], FACTOR, 0.033),
    Parameter("damping_n_m_s", "N m s/rad", _MOTOR_AT["damping_n_m_s"], FACTOR, 1.2e-4),
    Parameter("inertia_kg_m2", "kg m2", _MOTOR_AT["inertia_kg_m2"], FACTOR, 2e-5),
)
_FRICTION = (
    Parameter("mu_dry_1", "", _FRICTION_AT["dry_1"], WIDE_FACTOR, 0.25),
    Parameter("mu_dry_2", "s/mm", _FRICTION_AT["dry_2"], WIDE_FACTOR, 0.1),
    Parameter(
        "mu_dry_3",
        "",
        _FRICTION_AT["dry_3"],
        WIDE_FACTOR,
        0.75,
        (CoupledParameter("mu_dry_4", _FRICTION_AT["dry_4"], 10.0),),
    ),
    Parameter(
        "mu_wet_1",
        "",
        _FRICTION_AT["wet_1"],
        WIDE_FACTOR,
        0.6,
        (CoupledParameter("mu_wet_2", _FRICTION_AT["wet_2"], 10.0),),
    ),
    Parameter("mu_wet_3", "s/mm", _FRICTION_AT["wet_3"], WIDE_FACTOR, 0.01),
    Parameter(
        "mu_wet_4",
        "",
        _FRICTION_AT["wet_4"],
        WIDE_FACTOR,
        1.0,
        (CoupledParameter("mu_wet_5", _FRICTION_AT["wet_5"], 10.0),),
    ),
    Parameter("mu_wet_6", "s/mm", _FRICTION_AT["wet_6"], WIDE_FACTOR, 2e-4),
    Parameter("mu_wet_7", "1/N", _FRICTION_AT["wet_7"], WIDE_FACTOR, 0.025, signed=True),
)
_FORCE = Parameter(
    "force_n",
    "N",
    PARAMETER_INDEX["load.left_blade.force_n"],
    FACTOR,
    7.6,
    (CoupledParameter("right_force_n", PARAMETER_INDEX["load.right_blade.force_n"], 1.0),),
)

#: The seventeen of (5.1) and (5.23), in that order. What (5.1) calls mu_wet_2 is mu_wet_3 of (4.50).
SEVENTEEN = (*_MOTOR, *_FRICTION, _FORCE)

#: What may be asked for beside them.
OPTIONAL = (
    Parameter("coulomb_torque_n_m", "N m", _MOTOR_AT["coulomb_torque_n_m"], WIDE_FACTOR, 0.04),
    Parameter("gear_efficiency", "", _MOTOR_AT["gear_efficiency"], FACTOR, 1.0, highest=1.0),
    Parameter("gear_back_efficiency", "", _MOTOR_AT["gear_back_efficiency"], FACTOR, 0.3, highest=1.0),
    Parameter("left_wear", "", PARAMETER_INDEX["load.left_blade.wear"], FACTOR, 1.0),
    Parameter("right_wear", "", PARAMETER_INDEX["load.right_blade.wear"], FACTOR, 1.0),
    Parameter("mu_dry_4", "s/mm", _FRICTION_AT["dry_4"], WIDE_FACTOR, 7.5),
    Parameter("mu_wet_2", "s/mm", _FRICTION_AT["wet_2"], WIDE_FACTOR, 6.0),
    Parameter("mu_wet_5", "s/mm", _FRICTION_AT["wet_5"], WIDE_FACTOR, 10.0),
    Parameter("mu_tacky_1", "", _FRICTION_AT["tacky_1"], WIDE_FACTOR, 1.2),
    Parameter("mu_tacky_2", "s/mm", _FRICTION_AT["tacky_2"], WIDE_FACTOR, 7.5),
    Parameter("mu_tacky_3", "", _FRICTION_AT["tacky_3"], WIDE_FACTOR, 0.4),
    Parameter("mu_tacky_4", "s/mm", _FRICTION_AT["tacky_4"], WIDE_FACTOR, 0.01),
)

BY_NAME = {parameter.name: parameter for parameter in (*SEVENTEEN, *OPTIONAL)}


class Choice:
    """Which parameters are looked for, over a row that says all the others."""

    def __init__(self, parameters: Sequence[Parameter], base_row: Floats) -> None:
        self.parameters = tuple(parameters)
        self.base_row = np.array(base_row)
        free = {parameter.place for parameter in self.parameters}
        self._targets = [self._places(parameter, free) for parameter in self.parameters]

    def _places(self, parameter: Parameter, free: set[int]) -> list[tuple[int, float]]:
        places, own = [(parameter.place, 1.0)], self.base_row[parameter.place]
        for link in parameter.links:
            if link.place not in free:
                ratio = self.base_row[link.place] / own if own != 0.0 else 0.0
                places.append((link.place, ratio or link.ratio))
        return places

    def __len__(self) -> int:
        """Return how many parameters are looked for."""
        return len(self.parameters)

    @property
    def names(self) -> list[str]:
        """Their names, in order."""
        return [parameter.name for parameter in self.parameters]

    @property
    def values(self) -> Floats:
        """What the row says of them."""
        return np.array([self.base_row[parameter.place] for parameter in self.parameters])

    def rows(self, sets: Floats) -> Floats:
        """Return packed rows [sets, parameters] for values [sets, looked for]."""
        rows = np.tile(self.base_row, (len(sets), 1))
        for column, targets in enumerate(self._targets):
            for place, ratio in targets:
                rows[:, place] = ratio * sets[:, column]
        return rows

    def without(self, held: Sequence[str], values: Floats) -> "Choice":
        """Return the same without some, which keep what `values` say; so do all others, as a start."""
        row = self.rows(values[np.newaxis])[0]
        return Choice([parameter for parameter in self.parameters if parameter.name not in held], row)


def chosen(base_row: Floats, extra: Sequence[str] = (), held: Sequence[str] = ()) -> Choice:
    """Return the seventeen and those asked for, less those that are held.

    Raises
    ------
    Failure
        For a name that is none.

    """
    for name in (*extra, *held):
        if name not in BY_NAME:
            raise Failure(f"there is no parameter '{name}'; known: {', '.join(BY_NAME)}")
    names = [*(each.name for each in SEVENTEEN), *(name for name in extra)]
    return Choice([BY_NAME[name] for name in dict.fromkeys(names) if name not in held], base_row)


def of_the_wiper() -> list[str]:
    """Return the names of those that a motor alone does not have: friction and force of the blades."""
    return [parameter.name for parameter in (*_FRICTION, _FORCE)]


def search_space(choice: Choice, about: Floats) -> tuple[Floats, Floats]:
    """Return the lowest and highest values by (5.22) about what is known, `about`.

    Where nothing is known (0) it is from 0 to twice the usual value. A signed parameter may change its sign.
    """
    low, high = np.empty(len(choice)), np.empty(len(choice))
    for place, (parameter, value) in enumerate(zip(choice.parameters, about, strict=True)):
        size = abs(value)
        low[place], high[place] = size / parameter.factor, size * parameter.factor
        if size == 0.0:
            low[place], high[place] = 0.0, FACTOR * parameter.usual
        if parameter.signed:
            high[place] = parameter.factor * max(size, parameter.usual)
            low[place] = -high[place]
        high[place] = min(high[place], parameter.highest)
    return low, high
