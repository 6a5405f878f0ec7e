"""Where the cam of the depressed circuit holds its park contacts A and B, section 3.6.2 of Dooner (2016)."""

from hilplant.jit import compiled
from hilplant.models.park_switch import Contact, turned_back
from hilplant.models.records import ParkSwitch
from hilplant.models.wiring import DEPRESSED, PARKED, TURNING_BACK, WIPING
from hilplant.signals import Inputs


@compiled
def next_phase(
    inputs: Inputs, park_switch: ParkSwitch, contact: Contact, park_phase: float, crank_angle_rad: float
) -> float:
    """Return the position of park contacts A and B at this instant; `park_phase` is that of the tick before.

    Switched on they are at WIPING. Switched off they go to TURNING_BACK where the cam reaches park, and from there
    to PARKED once the crank is `reverse_angle_rad` before the angle at which the cam reached it.
    """
    if inputs.relay_on > 0.5 or park_switch.circuit != DEPRESSED:
        return WIPING
    if park_phase == WIPING:
        return TURNING_BACK if contact.closed > 0.5 else WIPING
    if park_phase == TURNING_BACK and turned_back(crank_angle_rad, park_switch) < park_switch.reverse_angle_rad:
        return TURNING_BACK
    return PARKED


@compiled
def phase_at_rest(crank_angle_rad: float, park_switch: ParkSwitch) -> float:
    """Return the position of contacts A and B in which a run begins.

    A crank of the depressed circuit that stands where turning back leaves it, or beyond by the width of the window
    at most, is parked. Anywhere else the contacts are where wiping has them.
    """
    if park_switch.circuit != DEPRESSED:
        return WIPING
    beyond = turned_back(crank_angle_rad, park_switch) - park_switch.reverse_angle_rad
    return PARKED if 0.0 <= beyond <= 2.0 * park_switch.half_window_rad else WIPING
