"""Straight and bent arms with their blades, in any combination, beside the equations as the thesis prints them.

Typed in from (4.35), (4.38) and (4.41), seen from the arm's pivot and the blade's joint; the blade's second body begins
at that joint, as the Jacobian (4.42) has it.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from hilplant.arrays import Floats
from hilplant.mechanics.motion import motion
from hilplant.mechanics.wiper import SideParts, Wiper, WiperParts, WiperSide, assemble
from hilplant.units import TURN_RAD


def angle_of(start: tuple[float, float], end: tuple[float, float]) -> float:
    return math.atan2(end[1] - start[1], end[0] - start[0])


def beginning(state: Floats, length: float) -> Floats:
    """Return R - l/2 (cos, sin) of a body's coordinates [m, 3]: the first rows of (4.35)."""
    return np.asarray(state[:, :2] - length / 2.0 * np.stack([np.cos(state[:, 2]), np.sin(state[:, 2])], axis=-1))


def ending(state: Floats, length: float) -> Floats:
    return np.asarray(2.0 * state[:, :2] - beginning(state, length))


def states(wiper: Wiper, coordinates: Floats, side: WiperSide) -> list[Floats]:
    """Return the coordinates of the side's bodies from the pivot outwards, [m, 3] each."""
    firsts = [3 * wiper.mechanism.bodies[name] for name in side.bodies]
    return [coordinates[:, first : first + 3] for first in firsts]


def turned(state: Floats, other: Floats) -> Floats:
    return np.asarray(np.remainder(state - other + math.pi, TURN_RAD) - math.pi)


@pytest.mark.parametrize("left", ["straight", "bent"])
@pytest.mark.parametrize("right", ["straight", "bent"])
@pytest.mark.parametrize("name", ["rhd_slave_driven", "lhd_master_driven", "rhd_centre_driven"])
def test_arms_and_blades_satisfy_the_printed_constraints_over_a_turn(
    name: str, left: str, right: str, shipped_parts: Callable[[str], WiperParts]
) -> None:
    parts = shipped_parts(name)
    shapes = {"straight" if len(one.arm) == 4 else "bent": one for one in (parts.left, parts.right)}
    wiper = assemble(replace(parts, left=shapes[left], right=shapes[right]))
    coordinates = motion(wiper, np.linspace(0.0, TURN_RAD, 49)).coordinates
    pivots = parts.linkage.left_pivot, parts.linkage.right_pivot
    for side, one, pivot in zip(wiper.sides, (shapes[left], shapes[right]), pivots, strict=True):
        bodies = states(wiper, coordinates, side)
        rocker = coordinates[:, wiper.mechanism.angle(side.rocker)]
        _check_arm(bodies[:-2], one, pivot, rocker)
        _check_blade(bodies, one)


def _check_arm(bodies: list[Floats], parts: SideParts, pivot: tuple[float, float], rocker_rad: Floats) -> None:
    """(4.35) of three bodies, (4.38) of two."""
    lengths = [math.dist(*pair) for pair in zip(parts.arm, parts.arm[1:], strict=False)]
    angles = [angle_of(*pair) for pair in zip(parts.arm, parts.arm[1:], strict=False)]
    assert len(bodies) == len(lengths)
    assert np.abs(beginning(bodies[0], lengths[0]) - np.array(pivot)).max() < 1e-13
    offset = angles[0] - rocker_rad[0]  # theta_o
    assert np.abs(turned(bodies[0][:, 2], rocker_rad + offset)).max() < 1e-13
    for at in range(1, len(bodies)):
        gap = ending(bodies[at - 1], lengths[at - 1]) - beginning(bodies[at], lengths[at])
        assert np.abs(gap).max() < 1e-13
        bend = angles[at] - angles[at - 1]  # k_theta
        assert np.abs(turned(bodies[at][:, 2], bodies[at - 1][:, 2] + bend)).max() < 1e-13


def _check_blade(bodies: list[Floats], parts: SideParts) -> None:
    """(4.41), both bodies beginning at the blade's joint."""
    assert parts.blade is not None
    *arm, first, second = bodies
    joint = ending(arm[-1], math.dist(parts.arm[-2], parts.arm[-1]))
    last_angle = angle_of(parts.arm[-2], parts.arm[-1])
    for body, tip in ((first, parts.blade[0]), (second, parts.blade[1])):
        assert np.abs(beginning(body, math.hypot(*tip)) - joint).max() < 1e-13
        offset = angle_of((0.0, 0.0), tip) - last_angle
        assert np.abs(turned(body[:, 2], arm[-1][:, 2] + offset)).max() < 1e-13
