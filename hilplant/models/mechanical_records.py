"""Records of what stands in the wiper's way and of what is loose or broken, declared where they stand.

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


class LinkageCondition(NamedTuple):
    """What is loose or broken between crank and blades; see :mod:`hilplant.models.linkage_faults`."""

    altered: Annotated[float, flag("1 where any of the others is not as declared here")] = 0.0
    left: Annotated[float, quantity("", "left arm: 0 whole, 1 lost with its blade, 2 its link is broken")] = 0.0
    right: Annotated[float, quantity("", "right arm: 0 whole, 1 lost with its blade, 2 its link is broken")] = 0.0
    backlash_rad: Annotated[float, quantity("rad", "play between crank and linkage, as angle of the crank")] = 0.0


class LinkageState(NamedTuple):
    """Where rockers stand whose link is broken."""

    left_rad: Annotated[float, quantity("rad", "angle of the left rocker since its link broke; 0: it is whole")] = 0.0
    right_rad: Annotated[float, quantity("rad", "the same of the right one")] = 0.0


class PlayState(NamedTuple):
    """Where the linkage is in its play."""

    ahead_rad: Annotated[float, quantity("rad", "how far the linkage is ahead of the crank, 0 to the backlash")] = 0.0
    speed_rad_s: Annotated[float, quantity("rad/s", "speed of the linkage as of its crank, while apart")] = 0.0
    apart: Annotated[float, flag("1 while crank and linkage do not touch", watched=False)] = 0.0
