"""Records of what changes slowly: parameters and states of heat, declared where they stand.

A group with `altered` 0 is not looked at: nothing of it is computed, and its states stay as they are.
"""

from typing import Annotated, NamedTuple

from hilplant.declaration import flag, quantity

#: Temperature [degC] at which resistances and constants of a motor are told unless something else is said.
ROOM_TEMPERATURE_C = 20.0


class Heat(NamedTuple):
    """The motor as two bodies, winding and case, and the thermal switch; see :mod:`hilplant.models.heat`."""

    altered: Annotated[float, flag("1 where the motor gets warm")] = 0.0
    winding_j_k: Annotated[float, quantity("J/K", "heat capacity of the armature with its winding")] = 1.0
    case_j_k: Annotated[float, quantity("J/K", "heat capacity of the case with the magnets")] = 1.0
    winding_to_case_w_k: Annotated[float, quantity("W/K", "conductance from the winding to the case")] = 1.0
    case_to_ambient_w_k: Annotated[float, quantity("W/K", "conductance from the case to the air")] = 1.0
    resistance_per_k: Annotated[float, quantity("1/K", "change of the winding's resistance")] = 0.0
    constant_per_k: Annotated[float, quantity("1/K", "change of the motor constant with the case's temperature")] = 0.0
    reference_c: Annotated[float, quantity("degC", "temperature at which the motor's parameters hold")] = (
        ROOM_TEMPERATURE_C
    )
    trip_c: Annotated[float, quantity("degC", "winding temperature at which the thermal switch opens")] = 0.0
    reset_c: Annotated[float, quantity("degC", "winding temperature at which it closes again")] = 0.0
    has_switch: Annotated[float, flag("1 where there is a thermal switch")] = 0.0
    start_c: Annotated[float, quantity("degC", "temperature of both bodies at the start")] = ROOM_TEMPERATURE_C


class HeatState(NamedTuple):
    """Temperatures of both bodies, and whether the thermal switch has opened."""

    winding_c: Annotated[float, quantity("degC", "temperature of the winding")] = ROOM_TEMPERATURE_C
    case_c: Annotated[float, quantity("degC", "temperature of the case and the magnets")] = ROOM_TEMPERATURE_C
    opened: Annotated[float, flag("1 while the thermal switch is open", watched=False)] = 0.0
