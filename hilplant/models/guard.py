"""No number that is not finite travels through the plant: the motor stops, and a flag says so until a restart.

What is watched, and what takes the place of each element, stands in the declarations of `State` and `Inputs`.
"""

from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models.records import State
from hilplant.models.row import all_finite, changed, guarded
from hilplant.signals import Inputs


class LastAngle(NamedTuple):
    """Where the crank was when it still was somewhere."""

    crank_angle_rad: float


@compiled
def admit(state: State, inputs: Inputs) -> tuple[State, Inputs]:
    """Return state and inputs as they are when all are finite and the guard is not set.

    Else the guard is set, the motor stands still without current where it was, its relays are off, and inputs that
    are not finite are 0.
    """
    if all_finite(state) and all_finite(inputs) and state.guard == 0.0:
        return state, inputs
    return guarded(state), guarded(inputs)


@compiled
def hold_if_wrong(state: State, last_angle: float) -> State:
    """Return `state`, or if its motion is not finite, or the guard set, a motor at rest at the last angle.

    A circuit that is switched off may still turn the motor; it must not when the guard is set.
    """
    if all_finite(state) and state.guard == 0.0:
        return state
    return guarded(changed(state, LastAngle(last_angle)))
