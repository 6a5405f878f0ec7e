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
def admitted(state: State) -> State:
    """Return a state from outside as it is when all of it is finite, else with the guard set."""
    return state if all_finite(state) else guarded(state)


@compiled
def admit(state: State, inputs: Inputs) -> tuple[State, Inputs]:
    """Return state and inputs as they are when all inputs are finite and the guard is not set.

    Else the guard is set, the motor stands still without current where it was, its relays are off, and inputs that
    are not finite are 0. The state is one that :func:`admitted` or :func:`hold_if_wrong` has returned.
    """
    if all_finite(inputs) and state.guard == 0.0:
        return state, inputs
    return guarded(state), guarded(inputs)


@compiled
def hold_if_wrong(state: State, last_angle: float, all_moves: bool) -> State:
    """Return `state`, or if it is not finite, or the guard set, a motor at rest at the last angle.

    Where not `all_moves`, only current, speed and angle can have become anything else. A circuit that is switched off
    may still turn the motor; it must not when the guard is set.
    """
    motion = 0.0 * (state.current_a + state.motor_speed_rad_s + state.crank_angle_rad)
    if motion == 0.0 and state.guard == 0.0 and (not all_moves or all_finite(state)):
        return state
    return guarded(changed(state, LastAngle(last_angle)))
