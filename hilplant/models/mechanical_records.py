"""Records of what stands in the wiper's way, declared where they stand.

A group with `altered` 0 is not looked at: nothing of it is computed, and its states stay as they are.
"""

from typing import Annotated, NamedTuple

from hilplant.declaration import flag, quantity


class SideObstacles(NamedTuple):
    """What one arm pushes against beyond two of its angles, and the ice that holds its blade."""

    low_rad: Annotated[float, quantity("rad", "arm angle below which something is in the way")] = 0.0
    low_n_m_rad: Annotated[float, quantity("N m/rad", "its stiffness, as torque at the arm by arm angle")] = 0.0
    high_rad: Annotated[float, quantity("rad", "arm angle above which something is in the way")] = 0.0
    high_n_m_rad: Annotated[float, quantity("N m/rad", "its stiffness")] = 0.0
    rebound: Annotated[float, quantity("", "part of its torque with which it pushes back: 0 snow, 1 a spring")] = 0.0
    frozen_n_m: Annotated[float, quantity("N m", "torque at the arm with which ice holds the blade")] = 0.0


class Obstacles(NamedTuple):
    """What stands in the wiper's way; see :mod:`hilplant.models.obstacles`."""

    altered: Annotated[float, flag("1 where any of the others is not as declared here")] = 0.0
    slip_rad: Annotated[float, quantity("rad", "how far an arm turns until its blade has left the ice")] = 0.0
    jam_rad: Annotated[float, quantity("rad", "crank angle at which something is jammed")] = 0.0
    jam_half_rad: Annotated[float, quantity("rad", "half the angle over which it is")] = 0.0
    jam_n_m: Annotated[float, quantity("N m", "torque at the crank with which it resists")] = 0.0
    left: SideObstacles = SideObstacles()
    right: SideObstacles = SideObstacles()


class IceState(NamedTuple):
    """How far each arm has turned against the ice."""

    left_rad: Annotated[float, quantity("rad", "turned by the left arm", watched=False)] = 0.0
    right_rad: Annotated[float, quantity("rad", "turned by the right arm", watched=False)] = 0.0
