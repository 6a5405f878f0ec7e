"""The elements of a run's rows by their names, and a row of another version in the order of this one's record.

What a row lacks has the default that is declared today. What it has beyond this version must have had its own default,
so that it changed nothing; else it is refused by name.
"""

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.declaration import Signal, declared, members
from hilplant.failure import Failure
from hilplant.models.records import Parameters, State
from hilplant.signals import Inputs, Outputs, Status

#: Names of a record's elements in the order of its packed row, each with its default; None where it has none.
Elements = Mapping[str, float | None]

ROWS: Mapping[str, type[Any]] = {
    "parameter_row": Parameters,
    "state_row": State,
    "inputs": Inputs,
    "outputs": Outputs,
    "status": Status,
}


class ForeignElement(Failure):
    """A recording has an element that this version cannot do without, or does not know; the message names it."""


def elements_of(record: type[Any]) -> dict[str, float | None]:
    """Return the elements of a record."""
    kind: Any = record  # of whose type the cache must not know
    return _elements_of(kind)


@cache
def _elements_of(record: Any) -> dict[str, float | None]:
    bare = set(_without_default(record))
    return {signal.name: None if signal.name in bare else signal.default for signal in declared(record)}


def adopted_row(row: Floats, recorded: Elements, record: type[Any]) -> Floats:
    """Return a packed row in the order of today's `record`; what stands behind the elements stays there.

    Raises
    ------
    ForeignElement
        When the row has an element that is not known here, with another value than its default, or lacks one that has
        no default.
    ValueError
        When the row is shorter than its elements.
    """
    names = list(recorded)
    if len(row) < len(names):
        raise ValueError(f"a row of {len(row)} numbers cannot hold {len(names)} elements")
    values = dict(zip(names, row.tolist(), strict=False))
    here = elements_of(record)
    for name in names:
        if name not in here and values[name] != recorded[name]:
            raise ForeignElement(f"{name} is {values[name]:g}, and this version has no such element")
    for name, default in here.items():
        if name not in values and default is None:
            raise ForeignElement(f"it has no {name}, for which there is no default")
    known = np.array([values.get(name, default) for name, default in here.items()], np.float64)
    return np.concatenate([known, row[len(names) :]])


def _without_default(record: type[Any], prefix: str = "") -> Iterator[str]:
    for name, member in members(record):
        if isinstance(member, Signal):
            if name not in record._field_defaults:
                yield prefix + name
        elif member is not None:
            yield from _without_default(member, f"{prefix}{name}.")


_BRUSH = ("resistance_ohm", "inductance_henry", "constant_v_s")
_FRICTION = (
    *(f"dry_{number}" for number in range(1, 5)),
    *(f"wet_{number}" for number in range(1, 8)),
    *(f"tacky_{number}" for number in range(1, 5)),
    "velocity_limit_mm_s",
)
#: Recordings of format 1 have no names: these are the elements of their rows, in their order.
FORMAT_1: Mapping[str, Elements] = {
    "parameter_row": dict.fromkeys((
        "step_s",
        *(f"motor.{brush}.{name}" for brush in ("slow", "fast") for name in _BRUSH),
        "motor.inertia_kg_m2", "motor.damping_n_m_s", "motor.coulomb_torque_n_m",
        "motor.gear_ratio", "motor.gear_efficiency", "motor.gear_back_efficiency",
        "park_switch.angle_rad", "park_switch.half_window_rad", "park_switch.hysteresis_rad",
        "park_switch.bounce_ticks", "park_switch.circuit", "park_switch.reverse_angle_rad",
        "load.model", "load.c1", "load.c2", "load.points",
        *(f"load.friction.{name}" for name in _FRICTION),
        *(f"load.{side}_blade.{name}" for side in ("left", "right") for name in ("force_n", "wear")),
        *(f"{side}_arm.{name}" for side in ("left", "right") for name in ("offset_rad", "length_m")),
        "motor_model",
    )),
    "state_row": dict.fromkeys((
        "current_a", "motor_speed_rad_s", "crank_angle_rad", "park_contact", "bounce_left", "guard", "park_phase",
        "memory.last.terminal_v", "memory.last.torque_n_m", "memory.last.current_a", "memory.last.speed_rad_s",
        "memory.brush", "memory.mode", "load_mode",
    )),
}  # fmt: skip
