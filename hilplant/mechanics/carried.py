"""One arm with its blade, laid on its rocker: bodies, rigid joints and masses, sections 4.2.2 and 4.2.3."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from hilplant.mechanics.arms import arm
from hilplant.mechanics.blades import Tips, blade_bodies, friction_pins
from hilplant.mechanics.coefficients import Aerodynamics, check_aerodynamics
from hilplant.mechanics.linkage import Linkage
from hilplant.mechanics.masses import MassError, check_mass, shared_by_length
from hilplant.mechanics.newton_raphson import positions
from hilplant.mechanics.planar import Body, Joint, Pin, Point, Rigid
from hilplant.models.records import Arm


@dataclass(frozen=True, slots=True)
class SideParts:
    """One arm with its blade.

    Attributes
    ----------
    arm
        Points of the arm at the design position [m], from :func:`hilplant.mechanics.arms.arm_points`.
    blade
        Tips of the blade seen from the arm's end [m], from :func:`hilplant.mechanics.blades.blade_tips`; None for a
        bare arm, whose end then stands for all points of a blade.
    arm_mass_kg, blade_mass_kg
        Shared among the arm's bodies, and the blade's, by their lengths.
    air
        Area and coefficients of the blade.

    """

    arm: tuple[Point, ...]
    blade: Tips | None = None
    arm_mass_kg: float = 0.0
    blade_mass_kg: float = 0.0
    air: Aerodynamics = field(default_factory=Aerodynamics)


@dataclass(frozen=True, slots=True)
class WiperSide:
    """One arm with its blade, as it sits in the mechanism.

    Attributes
    ----------
    name
        `left` or `right`.
    rocker
        Name of the body that carries the arm.
    arm
        Angle of the arm's first body less the rocker's, and the distance from the pivot to the blade's joint.
    bodies
        Names of the arm's and the blade's bodies, from the pivot outwards; the blade's end in `_blade_a`, `_blade_b`.
    fixed
        Where the origins of these bodies are on the rocker [m], and their angles less the rocker's [rad].
    pivot
        Where the arm turns.
    centre
        The blade's joint O.
    tips
        Both tips of the blade; none of a bare arm.
    friction
        The points at which friction acts.
    air
        Area and coefficients of the blade.

    """

    name: str
    rocker: str
    arm: Arm
    bodies: tuple[str, ...]
    fixed: tuple[tuple[Pin, float], ...]
    pivot: Pin
    centre: Pin
    tips: tuple[Pin, ...]
    friction: tuple[Pin, ...]
    air: Aerodynamics


@dataclass(frozen=True, slots=True)
class Carried:
    """What one rocker carries, before it is part of the mechanism."""

    side: WiperSide
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    masses_kg: Mapping[str, float]


def carried(linkage: Linkage, name: str, side: SideParts, points: int) -> Carried:
    """Lay an arm and its blade from the rocker's pivot outwards and fix each body to the one before.

    Parameters
    ----------
    linkage
        What the arm sits on.
    name
        `left` or `right`.
    side
        The arm and its blade.
    points
        Points of the blade at which friction acts.

    Raises
    ------
    MassError, CoefficientError, SolutionError
        For masses, an area or coefficients that mean nothing, and for a linkage that has no position.

    """
    rocker, pivot = getattr(linkage, f"{name}_rocker"), getattr(linkage, f"{name}_pivot")
    _check(name, side)
    rods = _arm_bodies(name, pivot, side.arm)
    rubber = () if side.blade is None else blade_bodies(name, _outer_end(pivot, side.arm), side.blade)
    park_rad = _rocker_at_park(linkage, rocker)
    record, seat = arm(side.arm, park_rad), linkage.body(rocker).local(pivot)
    held = Rigid((rocker, seat), rods[0].first_end, record.offset_rad)
    row = [Rigid(inner.second_end, outer.first_end, _bend(inner, outer)) for inner, outer in pairwise(rods)]
    ends = [Rigid(rods[-1].second_end, body.first_end, _bend(rods[-1], body)) for body in rubber]
    masses = shared_by_length(rods, side.arm_mass_kg) | shared_by_length(rubber, side.blade_mass_kg)
    centre = rods[-1].second_end if not rubber else rubber[0].first_end
    assembled = WiperSide(
        name=name,
        rocker=rocker,
        arm=record,
        bodies=tuple(body.name for body in (*rods, *rubber)),
        fixed=tuple(_fixed(body, (rocker, seat), pivot, park_rad) for body in (*rods, *rubber)),
        pivot=rods[0].first_end,
        centre=centre,
        tips=tuple(body.second_end for body in rubber),
        friction=friction_pins(rubber, points) if rubber else (centre,) * points,
        air=side.air,
    )
    return Carried(assembled, (*rods, *rubber), (held, *row, *ends), masses)


def _check(name: str, side: SideParts) -> None:
    check_aerodynamics(f"{name} blade", side.air)
    check_mass(f"{name} arm: mass_kg", side.arm_mass_kg)
    check_mass(f"{name} blade: mass_kg", side.blade_mass_kg)
    if side.blade is None and side.blade_mass_kg > 0.0:
        raise MassError(f"{name} blade: has a mass of {side.blade_mass_kg} kg, but no points say where it is")


def _arm_bodies(name: str, pivot: Point, points: tuple[Point, ...]) -> list[Body]:
    """Return the arm's rods with its first point on the pivot."""
    shift = pivot[0] - points[0][0], pivot[1] - points[0][1]
    laid = [(x + shift[0], y + shift[1]) for x, y in points]
    return [Body.between(f"{name}_arm_{index}", *ends) for index, ends in enumerate(pairwise(laid), start=1)]


def _outer_end(pivot: Point, points: tuple[Point, ...]) -> Point:
    return pivot[0] + points[-1][0] - points[0][0], pivot[1] + points[-1][1] - points[0][1]


def _fixed(body: Body, seat: Pin, pivot: Point, rocker_rad: float) -> tuple[Pin, float]:
    """Return where a body that stands on its design points is on its rocker, and its angle less the rocker's."""
    frame = Body(seat[0], pivot, rocker_rad, 0.0)
    x, y = frame.local(body.origin_m)
    return (seat[0], (seat[1][0] + x, seat[1][1] + y)), body.angle_rad - rocker_rad


def _bend(inner: Body, outer: Body) -> float:
    return outer.angle_rad - inner.angle_rad


def _rocker_at_park(linkage: Linkage, rocker: str) -> float:
    """Return the rocker's angle at crank angle 0 [rad]: rounded design points do not meet to the last digit."""
    mechanism = linkage.mechanism()
    coordinates = positions(mechanism, mechanism.design, np.array(linkage.design_crank_angle_rad))
    return float(coordinates[mechanism.angle(rocker)])
