"""The linkage file of a bench, with its arms and blades -> the whole wiper and its table over the crank angle."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import TypeVar

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.parts import ArmSection, BladeSection, LinkageFile
from hilplant.checked_yaml.spot import Spot
from hilplant.failure import Failure
from hilplant.mechanics import collision
from hilplant.mechanics.arms import arm_points
from hilplant.mechanics.assembly import assembly
from hilplant.mechanics.blades import blade_tips
from hilplant.mechanics.centre_driven import centre_driven
from hilplant.mechanics.coefficients import Aerodynamics, CoefficientError
from hilplant.mechanics.design_points import tilt_of
from hilplant.mechanics.linkage import Linkage
from hilplant.mechanics.masses import linkage_masses
from hilplant.mechanics.master_driven import master_driven
from hilplant.mechanics.planar import Point
from hilplant.mechanics.slave_driven import slave_driven
from hilplant.mechanics.tables import run_time_table
from hilplant.mechanics.transmission import Closeness, check_transmission
from hilplant.mechanics.wiper import SideParts, Wiper, WiperParts, assemble
from hilplant.models.tables import LEFT_ROCKER, RIGHT_ROCKER
from hilplant.units import RAD_PER_DEG

Built = TypeVar("Built")

SIDES = ("left", "right")
#: Beyond this tilt a link would lose more than 0.1 % of its length [rad].
MOST_TILT_RAD = 0.045
MAKERS = {"slave_driven": slave_driven, "master_driven": master_driven, "centre_driven": centre_driven}


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What the wiper's mechanics need to know from outside the linkage spot.

    `air` are area and coefficients of the left and the right blade; `needs_masses` says whether none may be missing.
    """

    screen_angle_rad: float
    air: tuple[Aerodynamics, Aerodynamics]
    points: int
    needs_masses: bool


@dataclass(frozen=True, slots=True)
class Mechanics:
    """A wiper that was put together: its spot, its parts and its table over the crank angle.

    `closest` is the place of a turn nearest to a dead point, `clearance_m` the least distance of the blades.
    """

    written: LinkageFile
    linkage: Linkage
    wiper: Wiper
    table: Floats
    closest: Closeness
    clearance_m: float


def build_mechanics(plant: Spot, written: LinkageFile, around: Surroundings) -> Mechanics | None:
    """Build the wiper of a plant; all that is wrong with it is noted."""
    spot = plant.inner("linkage")
    parts = None if _is_tilted(spot, written) else _parts(spot, written, around)
    if parts is None:
        return None
    try:
        closest, wiper, table = _tabulated(_ByContent(parts, written.least_transmission_deg))
    except CoefficientError as error:
        plant.note("blades", text=str(error))
        return None
    except Failure as error:
        spot.note("points_m", text=str(error))
        return None
    clearance = _attempt(spot.inner("least_clearance_m"), lambda: _clearance(written, parts, table))
    return Mechanics(written, parts.linkage, wiper, table, closest, clearance) if clearance is not None else None


def _is_tilted(spot: Spot, written: LinkageFile) -> bool:
    """Note points that lie in another plane than XY: along Z they would be another, smaller wiper."""
    parts = (written, written.left_arm, written.right_arm, written.left_blade, written.right_blade)
    tilt_rad = tilt_of(part.points_m for part in parts)
    if tilt_rad <= MOST_TILT_RAD:
        return False
    text = f"the points lie in a plane that is tilted by {tilt_rad / RAD_PER_DEG:.1f} deg against X and Y, as in the "
    spot.note("points_m", text=f"{text}vehicle's axes; turn them into the screen's plane, and give its angle_rad")
    return True


class _ByContent:
    """Parts that are the same where all their numbers are."""

    def __init__(self, parts: WiperParts, least_transmission_deg: float) -> None:
        self.parts = parts
        self.least_transmission_deg = least_transmission_deg
        self._content = f"{least_transmission_deg!r} {parts!r}"

    def __hash__(self) -> int:
        return hash(self._content)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _ByContent) and self._content == other._content


@lru_cache(maxsize=16)
def _tabulated(same: _ByContent) -> tuple[Closeness, Wiper, Floats]:
    """Do what takes long, once for wipers that are the same: programs load one bench again and again."""
    closest = check_transmission(same.parts.linkage, same.least_transmission_deg)
    wiper = assemble(same.parts)
    return closest, wiper, run_time_table(wiper)


def _parts(spot: Spot, written: LinkageFile, around: Surroundings) -> WiperParts | None:
    complete = not around.needs_masses or _has_masses(spot, written)
    linkage = _attempt_linkage(spot, lambda: _linkage(written))
    left, right = (_side(spot, written, side, air) for side, air in zip(SIDES, around.air, strict=True))
    if linkage is None or left is None or right is None:
        return None
    masses = _attempt(spot.inner("masses_kg"), lambda: linkage_masses(linkage.bodies, written.masses_kg or {}))
    if masses is None or not complete:
        return None
    damping = written.pivot_damping_n_m_s
    return WiperParts(linkage, left, right, masses, around.screen_angle_rad, damping, around.points)


def _linkage(written: LinkageFile) -> Linkage:
    if written.kind == "assembly":
        return assembly(written.description())
    return MAKERS[written.kind](written.points_m)


def _side(spot: Spot, written: LinkageFile, side: str, air: Aerodynamics) -> SideParts | None:
    arm, blade = _sections(written, side)
    points = _attempt(spot.inner(f"{side}_arm", "points_m"), partial(arm_points, arm.kind, arm.points_m))
    tips = _attempt(spot.inner(f"{side}_blade", "points_m"), partial(blade_tips, blade.points_m))
    if points is None or tips is None:
        return None
    return SideParts(points, tips, arm.mass_kg or 0.0, blade.mass_kg or 0.0, air)


def _sections(written: LinkageFile, side: str) -> tuple[ArmSection, BladeSection]:
    return (written.left_arm, written.left_blade) if side == "left" else (written.right_arm, written.right_blade)


def _has_masses(spot: Spot, written: LinkageFile) -> bool:
    """Say whether there are masses of everything that moves; note each that is missing."""
    missing = [] if written.masses_kg else ["masses_kg"]
    for side in SIDES:
        arm, blade = _sections(written, side)
        missing += [f"{side}_arm"] if arm.mass_kg is None else []
        missing += [f"{side}_blade"] if blade.mass_kg is None else []
    for key in missing:
        name = "mass_kg" if key != "masses_kg" else key
        spot.note(key, text=f"key '{name}' is missing; the reduced load needs the mass of everything that moves")
    return not missing


def _clearance(written: LinkageFile, parts: WiperParts, table: Floats) -> float:
    """Return how near the blades come to each other [m]; refuse less than the file demands."""
    pivots = (parts.linkage.left_pivot, parts.linkage.right_pivot)
    channels = (LEFT_ROCKER, RIGHT_ROCKER)
    left, right = (
        collision.SweepSide(pivot, _blade_lines(side), np.ascontiguousarray(table[:, channel, 0]))
        for pivot, side, channel in zip(pivots, (parts.left, parts.right), channels, strict=True)
    )
    if written.least_clearance_m is not None:
        collision.check_clearance(left, right, written.least_clearance_m)
    return collision.clearance(left, right)[0]


def _blade_lines(side: SideParts) -> list[collision.Line]:
    """Return both halves of a blade seen from the pivot."""
    joint: Point = side.arm[-1][0] - side.arm[0][0], side.arm[-1][1] - side.arm[0][1]
    return [(joint, (joint[0] + tip[0], joint[1] + tip[1])) for tip in side.blade or ()]


def _attempt_linkage(spot: Spot, build: Callable[[], Linkage]) -> Linkage | None:
    """Build a linkage; its errors may know the part of the file they are about."""
    try:
        return build()
    except Failure as error:
        part: tuple[str | int, ...] = getattr(error, "part", ()) or ("points_m",)
        spot.note(*part, text=str(error))
        return None


def _attempt(spot: Spot, build: Callable[[], Built]) -> Built | None:
    try:
        return build()
    except Failure as error:
        spot.note(text=str(error))
        return None
