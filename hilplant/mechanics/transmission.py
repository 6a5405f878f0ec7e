"""How near a linkage comes to a dead point while its crank turns: its transmission angles.

The angle at the joint of a dyad between the ways to its two outer pins is the transmission angle. Near 0 or
180 deg the dyad lies in one line: small forces at the crank become large ones in the joints, rounded points decide
which way it folds, and at the dead point itself the positions are not settled. So the smallest distance of this
angle from the line is the measure; text books ask for 40 deg or more in a machine that runs well.

Three or more bodies that only settle each other have no such angle. Their measure is the smallest singular value of
their part of the Jacobian, turning counted by each body's length. For a dyad near its line that is sqrt(2/15) of the
transmission angle, whatever the lengths; divided by it, it is the angle of a dyad as near to its dead point.
"""

import math
from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.mechanics.design_points import GeometryError
from hilplant.mechanics.dyads import Dyad, taken_apart
from hilplant.mechanics.linkage import CLOSURE_RAD, Linkage
from hilplant.mechanics.newton_raphson import SolutionError, follow, follow_as_far
from hilplant.mechanics.planar import Mechanism
from hilplant.units import RAD_PER_DEG, TURN_RAD

#: Smallest transmission angle that is accepted unless another one is asked for.
LEAST_TRANSMISSION_DEG = 20.0
#: Smallest singular value of a dyad for each radian of its transmission angle, near the line.
SINGULAR_VALUE_PER_RAD = math.sqrt(2.0 / 15.0)
#: Crank angles at which a turn is looked at.
KNOTS = 1024


@dataclass(frozen=True, slots=True)
class Closeness:
    """The place of a turn nearest to a dead point.

    Attributes
    ----------
    where
        The joint and its bodies, in words.
    crank_angle_rad
        From the design position [rad].
    transmission_angle_rad
        Distance of the transmission angle from the line, 0 to pi/2 [rad]; where there is no dyad, the angle of one
        as near to its dead point.

    """

    where: str
    crank_angle_rad: float
    transmission_angle_rad: float


def check_transmission(linkage: Linkage, least_deg: float = LEAST_TRANSMISSION_DEG) -> Closeness:
    """Refuse a linkage that comes too near to a dead point; return how near it comes.

    Raises
    ------
    GeometryError
        With joint, angle, crank angle and limit.

    """
    places = closest_places(linkage)
    for place in places:
        _check_place(place, least_deg)
    return min(places, key=lambda place: place.transmission_angle_rad)


def _check_place(place: Closeness, least_deg: float) -> None:
    crank = f"crank angle {place.crank_angle_rad / RAD_PER_DEG:.1f} deg"
    angle = place.transmission_angle_rad / RAD_PER_DEG
    if angle < least_deg:
        raise GeometryError(
            f"linkage: too near to a dead point: the transmission angle at {place.where} is {angle:.2f} deg off "
            f"the line at {crank}, which must be at least {least_deg:.4g} deg: change the lengths of these bodies "
            "so that they come less near to lying in one line, or shorten the crank"
        )


def check_rocking(linkage: Linkage) -> None:
    """Refuse a linkage whose crank cannot make its turn, or one of whose rockers goes round with it."""
    mechanism, coordinates = followed_turn(linkage)
    for rocker in (linkage.left_rocker, linkage.right_rocker):
        angle = coordinates[:, mechanism.angle(rocker)]
        gap = abs(float(angle[-1] - angle[0]))
        if gap > CLOSURE_RAD:
            raise GeometryError(
                f"linkage: {rocker} does not rock: after one turn of the crank it has turned by "
                f"{gap / RAD_PER_DEG:.4g} deg, must be back where it began"
            )


def closest_places(linkage: Linkage) -> list[Closeness]:
    """Return where in a turn, looked at in `KNOTS` steps, each dyad and what is in none is nearest to a dead point.

    Raises
    ------
    GeometryError
        When the turn cannot be followed, with the place where it ends.

    """
    mechanism, coordinates = followed_turn(linkage)
    found, left_over = taken_apart(linkage)
    places = [_narrowest(linkage, mechanism, coordinates, dyad) for dyad in found]
    return [*places, _loosest(linkage, mechanism, coordinates, left_over)] if left_over else places


def followed_turn(linkage: Linkage) -> tuple[Mechanism, Floats]:
    """Return the mechanism and its coordinates [KNOTS + 1, n] over one turn of the crank."""
    mechanism = linkage.mechanism()
    crank_rad = linkage.design_crank_angle_rad + np.linspace(0.0, TURN_RAD, KNOTS + 1)
    try:
        return mechanism, follow(mechanism, crank_rad)
    except SolutionError:
        raise GeometryError(_where_it_ends(linkage, mechanism, crank_rad)) from None


def _narrowest(linkage: Linkage, mechanism: Mechanism, coordinates: Floats, dyad: Dyad) -> Closeness:
    angle = dyad.angle_rad(mechanism, coordinates)
    from_line = np.minimum(angle, math.pi - angle)
    knot = int(from_line.argmin())
    shared = [point for point in linkage.body_points[dyad.bodies[0]] if point in linkage.body_points[dyad.bodies[1]]]
    where = f"{shared[0] if shared else 'the joint'} between {dyad.bodies[0]} and {dyad.bodies[1]}"
    return Closeness(where, TURN_RAD * knot / KNOTS, float(from_line[knot]))


def _loosest(linkage: Linkage, mechanism: Mechanism, coordinates: Floats, bodies: list[str]) -> Closeness:
    """Return where bodies that only settle each other are least held."""
    columns = np.concatenate([mechanism.angle(body) - np.array([2, 1, 0]) for body in bodies])
    rows = np.flatnonzero(np.abs(mechanism.linear[:, columns]).max(axis=1))
    scales = np.concatenate([[1.0, 1.0, 1.0 / linkage.body(body).length_m] for body in bodies])
    held = mechanism.jacobian(coordinates)[:, rows[:, np.newaxis], columns] * scales
    least = np.linalg.svd(held, compute_uv=False)[:, -1]
    knot = int(least.argmin())
    angle = min(float(least[knot]) / SINGULAR_VALUE_PER_RAD, math.pi / 2.0)
    return Closeness(", ".join(bodies), TURN_RAD * knot / KNOTS, angle)


def _where_it_ends(linkage: Linkage, mechanism: Mechanism, crank_rad: Floats) -> str:
    """Follow the turn as far as it goes, and say which joint holds it up."""
    try:
        knot, coordinates = follow_as_far(mechanism, crank_rad)
    except SolutionError as error:
        return f"linkage: the joints cannot be brought together at the design position: {error}"
    crank = f"linkage: the crank cannot turn past {(crank_rad[knot] - crank_rad[0]) / RAD_PER_DEG:.1f} deg"
    places = [(_narrowest(linkage, mechanism, coordinates[np.newaxis], dyad), dyad) for dyad in taken_apart(linkage)[0]]
    if not places:
        return f"{crank}: there the bodies are in a dead point"
    place, dyad = min(places, key=lambda entry: entry[0].transmission_angle_rad)
    joint, first, second = (
        mechanism.point(coordinates, pin) for pin in (dyad.joint, dyad.first_outer, dyad.second_outer)
    )
    lengths = [float(np.hypot(*(outer - joint))) for outer in (first, second)]
    if dyad.angle_rad(mechanism, coordinates) > math.pi / 2.0:
        return (
            f"{crank}: there {place.where} lies stretched, and its outer pins go farther apart than "
            f"{lengths[0]:.4g} + {lengths[1]:.4g} = {sum(lengths):.4g} m: lengthen one of these bodies"
        )
    return (
        f"{crank}: there {place.where} lies folded, and its outer pins come nearer than "
        f"|{lengths[0]:.4g} - {lengths[1]:.4g}| = {abs(lengths[0] - lengths[1]):.4g} m: "
        "bring the lengths of these bodies nearer to each other"
    )
