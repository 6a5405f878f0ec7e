"""The whole wiper as one mechanism: a linkage, two arms on its rockers, a blade on each arm, with their masses.

Everything follows the crank angle alone. How the parts become the table that the step reads::

    linkage = slave_driven(written["points_m"])
    left = SideParts(
        arm=arm_points("straight", written["left_arm"]["points_m"]),
        blade=blade_tips(written["left_blade"]["points_m"]),
        arm_mass_kg=0.5,
        blade_mass_kg=0.3,
        air=Aerodynamics(area_m2=0.07, drag=0.175, lift=[(90.0, 0.05), (180.0, 0.06)]),
    )
    parts = WiperParts(linkage, left, right, masses_kg={"crank": 0.0845, ...}, screen_angle_rad=-0.57, points=1)
    wiper = assemble(parts)
    table = run_time_table(wiper)  # of hilplant.mechanics.tables, [knots + 1, channels, 2]
    left_arm = wiper.left.arm  # the record hilplant.models.records.Arm

Masses may be left out: the channels of inertia and gravity are then zero. Each kind of wrong input raises its own
`Failure`: `GeometryError`, `MassError`, `CoefficientError`, `SolutionError`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from hilplant.arrays import Floats
from hilplant.mechanics.carried import SideParts, WiperSide, carried
from hilplant.mechanics.coefficients import CoefficientError
from hilplant.mechanics.design_points import GeometryError
from hilplant.mechanics.linkage import Linkage
from hilplant.mechanics.masses import gravity_in_plane, linkage_masses, rod_inertias
from hilplant.mechanics.planar import Body, Joint, Mechanism
from hilplant.mechanics.turn import Turn, followed

__all__ = ["AIR_DENSITY_KG_M3", "SideParts", "Wiper", "WiperParts", "WiperSide", "assemble"]

#: Mass density of air of section 4.5 [kg/m3].
AIR_DENSITY_KG_M3 = 1.225


@dataclass(frozen=True, slots=True)
class WiperParts:
    """What a wiper is put together from.

    Attributes
    ----------
    linkage, left, right
        The parts that move.
    masses_kg
        Mass of each moving body of the linkage, by name; empty when none are known.
    pivot_damping_n_m_s
        Viscous damping of crank and rockers, each in its pivot on the ground.
    screen_angle_rad
        gamma of (4.47).
    points
        Points of each blade at which friction acts, evenly along it; 1 is the arm's end, as in the thesis.
    air_density_kg_m3
        rho of (4.51), (4.52).

    """

    linkage: Linkage
    left: SideParts
    right: SideParts
    masses_kg: Mapping[str, float] = field(default_factory=dict)
    screen_angle_rad: float = 0.0
    pivot_damping_n_m_s: float = 0.0
    points: int = 1
    air_density_kg_m3: float = AIR_DENSITY_KG_M3


@dataclass(frozen=True, slots=True)
class Wiper:
    """All bodies and joints, their masses, and what acts on them.

    Attributes
    ----------
    mechanism
        Linkage, arms and blades, driven by the crank.
    bodies, joints
        Of the mechanism, in its order.
    masses_kg, inertias_kg_m2
        Of each body; the moment of inertia is about its origin, the middle of the rod. The ground has none.
    gravity_m_s2
        Along -Y.
    park_rad
        Angle of the crank from +X at crank angle 0.
    linkage
        The linkage alone, which settles where arms and blades are; its bodies are the first of the whole mechanism.
    turn
        One turn of the linkage, from which positions at other crank angles are found.
    left, right
        What the rockers carry.
    air_density_kg_m3
        rho of (4.51), (4.52).
    crank, pivot_damping_n_m_s
        Name of that body; damping of crank and rockers, each in its pivot on the ground.

    """

    mechanism: Mechanism
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    masses_kg: Floats
    inertias_kg_m2: Floats
    gravity_m_s2: float
    park_rad: float
    linkage: Mechanism
    turn: Turn
    left: WiperSide
    right: WiperSide
    air_density_kg_m3: float
    crank: str
    pivot_damping_n_m_s: float

    @property
    def pivoted(self) -> tuple[str, str, str]:
        """Names of the bodies that turn about a pivot on the ground: crank, left and right rocker."""
        return self.crank, self.left.rocker, self.right.rocker

    @property
    def sides(self) -> tuple[WiperSide, WiperSide]:
        """Left and right."""
        return self.left, self.right


def assemble(parts: WiperParts) -> Wiper:
    """Put the parts together.

    Raises
    ------
    GeometryError, MassError, CoefficientError, SolutionError
        For parts from which no wiper can be built; the text names the part.

    """
    _check(parts)
    linkage, masses_kg = parts.linkage, linkage_masses(parts.linkage.bodies, parts.masses_kg)
    left = carried(linkage, "left", parts.left, parts.points)
    right = carried(linkage, "right", parts.right, parts.points)
    bodies = (*linkage.bodies, *left.bodies, *right.bodies)
    _check_names(bodies)
    joints = (*linkage.joints, *left.joints, *right.joints)
    weights = {"ground": 0.0} | masses_kg | dict(left.masses_kg) | dict(right.masses_kg)
    in_order = np.array([weights[body.name] for body in bodies])
    moving, park_rad = linkage.mechanism(), linkage.design_crank_angle_rad
    return Wiper(
        mechanism=Mechanism(bodies, joints),
        bodies=bodies,
        joints=joints,
        masses_kg=in_order,
        inertias_kg_m2=rod_inertias(bodies, in_order),
        gravity_m_s2=gravity_in_plane(parts.screen_angle_rad),
        park_rad=park_rad,
        linkage=moving,
        turn=followed(moving, park_rad, (linkage.left_rocker, linkage.right_rocker)),
        left=left.side,
        right=right.side,
        air_density_kg_m3=parts.air_density_kg_m3,
        crank=linkage.crank,
        pivot_damping_n_m_s=parts.pivot_damping_n_m_s,
    )


def _check(parts: WiperParts) -> None:
    if parts.points < 1:
        raise GeometryError(f"points: friction acts on at least 1 point of a blade, not {parts.points}")
    if not (math.isfinite(parts.air_density_kg_m3) and parts.air_density_kg_m3 > 0.0):
        raise CoefficientError(f"air density: must be above 0 kg/m3, not {parts.air_density_kg_m3}")
    if not (math.isfinite(parts.pivot_damping_n_m_s) and parts.pivot_damping_n_m_s >= 0.0):
        raise CoefficientError(f"damping of the pivots: must be at least 0 N m s/rad, not {parts.pivot_damping_n_m_s}")


def _check_names(bodies: tuple[Body, ...]) -> None:
    names = [body.name for body in bodies]
    for name in names:
        if names.count(name) > 1:
            raise GeometryError(f"linkage: the name {name} of a body is that of an arm's or blade's; choose another")
