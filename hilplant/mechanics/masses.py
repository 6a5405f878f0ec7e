"""Masses and moments of inertia of the bodies, each a slender rod, (4.43)."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.mechanics.planar import Body

#: Of the thesis, (4.48) [m/s2].
GRAVITY_M_S2 = 9.81
#: A screen that lies flat may be written as 1.5708 rad.
ROUNDED_RAD = 1e-5


class MassError(Failure):
    """Masses that are missing, of no body, or negative."""


def linkage_masses(bodies: Sequence[Body], masses_kg: Mapping[str, float]) -> dict[str, float]:
    """Return the mass of each body of a linkage [kg]; none at all when no mass is given.

    Raises
    ------
    MassError
        For a mass of an unknown body, for one that is missing beside others, and for a negative one.

    """
    moving = [body.name for body in bodies if body.name != "ground"]
    if masses_kg and set(masses_kg) != set(moving):
        raise MassError(f"masses_kg: needs {', '.join(moving)}, has {', '.join(masses_kg)}")
    for name, mass_kg in masses_kg.items():
        check_mass(f"masses_kg: {name}", mass_kg)
    return dict.fromkeys(moving, 0.0) | dict(masses_kg)


def check_mass(owner: str, mass_kg: float) -> None:
    """Refuse what cannot be a mass."""
    if not (math.isfinite(mass_kg) and mass_kg >= 0.0):
        raise MassError(f"{owner}: a mass is a number of at least 0 kg, not {mass_kg}")


def shared_by_length(bodies: Sequence[Body], mass_kg: float) -> dict[str, float]:
    """Share one mass [kg] among rods of the same section, in proportion to their lengths."""
    whole = math.fsum(body.length_m for body in bodies)
    return {body.name: mass_kg * body.length_m / whole for body in bodies}


def rod_inertias(bodies: Sequence[Body], masses_kg: Floats) -> Floats:
    """Return each body's moment of inertia about its middle [kg m2], m l^2 / 12 of (4.43)."""
    lengths = np.array([body.length_m for body in bodies])
    return np.asarray(masses_kg * lengths**2 / 12.0)


def gravity_in_plane(screen_angle_rad: float) -> float:
    """Return the part of gravity along -Y of the screen's plane [m/s2], (4.47), (4.48).

    Parameters
    ----------
    screen_angle_rad
        gamma, the turn of the plane about X: 0 is an upright screen, a quarter turn one that lies flat. Its sign
        does not matter for what stays in the plane.

    """
    if not abs(screen_angle_rad) <= math.pi / 2.0 + ROUNDED_RAD:
        raise MassError(f"screen angle: must lie within a quarter turn, not {screen_angle_rad} rad")
    return GRAVITY_M_S2 * math.cos(screen_angle_rad)
