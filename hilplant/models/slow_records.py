"""Records of what changes slowly: parameters and states of heat, wear and water, declared where they stand.

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


class Wear(NamedTuple):
    """How the wiper wears with its wipes; see :mod:`hilplant.models.wear`."""

    altered: Annotated[float, flag("1 where the wiper wears")] = 0.0
    blades: Annotated[float, quantity("", "part by which a wipe raises the friction of both blades")] = 0.0
    brushes_ohm: Annotated[float, quantity("Ohm", "resistance that a wipe adds at both brushes")] = 0.0
    cam_rad: Annotated[float, quantity("rad", "what a wipe takes from half the window of the park switch")] = 0.0
    start_wipes: Annotated[float, quantity("", "wipes at the start")] = 0.0


class WearState(NamedTuple):
    """How much the wiper has wiped."""

    wipes: Annotated[float, quantity("", "turns of the crank so far, in either direction")] = 0.0


class Water(NamedTuple):
    """Water on the screen and the rain sensor; see :mod:`hilplant.models.water`."""

    altered: Annotated[float, flag("1 where water is modelled")] = 0.0
    catch: Annotated[float, quantity("", "part of the rain that the standing screen catches")] = 0.0
    catch_s_m: Annotated[float, quantity("s/m", "what the vehicle's speed adds to that")] = 0.0
    washer_mm_s: Annotated[float, quantity("mm/s", "film that the washer lays")] = 0.0
    runoff_per_s: Annotated[float, quantity("1/s", "part of the film that runs off")] = 0.0
    evaporation_mm_s: Annotated[float, quantity("mm/s", "film that evaporates")] = 0.0
    wiped: Annotated[float, quantity("", "logarithm of the film before and after the pass of a blade")] = 0.0
    dry_mm: Annotated[float, quantity("mm", "film below which the screen is dry")] = 0.0
    tacky_mm: Annotated[float, quantity("mm", "film at which it is tacky")] = 0.5
    wet_mm: Annotated[float, quantity("mm", "film above which it is wet")] = 1.0
    sensor_mm: Annotated[float, quantity("mm", "film at which the rain sensor shows 63 %")] = 1.0
    start_mm: Annotated[float, quantity("mm", "film at the start")] = 0.0


class WaterState(NamedTuple):
    """The water on the screen."""

    film_mm: Annotated[float, quantity("mm", "mean thickness of the film")] = 0.0
