"""Whether bodies and joints make a linkage of one degree of freedom at all."""

from collections import Counter

import numpy as np

from hilplant.arrays import Floats
from hilplant.mechanics.design_points import GeometryError
from hilplant.mechanics.linkage import Linkage
from hilplant.mechanics.planar import Ground, Mechanism, Revolute, Rigid

#: A singular value below this share of the largest one counts as none.
RANK = 1e-9


def check_structure(linkage: Linkage) -> None:
    """Refuse bodies that hang on nothing, a wrong count of joints, double hold and a start in a dead point.

    Raises
    ------
    GeometryError
        With the bodies it is about.

    """
    _check_connected(linkage)
    _check_count(linkage)
    mechanism = linkage.mechanism()
    anywhere = np.random.default_rng(1).uniform(-1.0, 1.0, mechanism.design.size) * _length(linkage)
    anywhere[2::3] = np.random.default_rng(2).uniform(-3.0, 3.0, len(mechanism.bodies))
    if loose := _loose_bodies(linkage, mechanism, anywhere):
        raise GeometryError(
            f"linkage: with the crank held, {', '.join(loose)} can still move while other bodies are held more "
            "than once: take a joint from those and give it to these"
        )
    if loose := _loose_bodies(linkage, mechanism, mechanism.design):
        raise GeometryError(
            f"linkage: the design position is a dead point: with the crank held, {', '.join(loose)} can still "
            "move; write the points down at another crank angle, or change the lengths"
        )


def _check_connected(linkage: Linkage) -> None:
    reached = {"ground"}
    pairs = [{joint.first[0], joint.second[0]} for joint in linkage.joints if isinstance(joint, Revolute | Rigid)]
    pairs += [{"ground", joint.body} for joint in linkage.joints if isinstance(joint, Ground)]
    for _ in linkage.bodies:
        reached.update(*(pair for pair in pairs if pair & reached))
    if apart := [body.name for body in linkage.bodies if body.name not in reached]:
        raise GeometryError(f"linkage: no row of joints connects {', '.join(apart)} with the ground")


def _check_count(linkage: Linkage) -> None:
    """Count degrees of freedom as Gruebler does: one is the crank's, and there must be no other."""
    count = Counter(type(joint) for joint in linkage.joints)
    moving, grounded = len(linkage.bodies) - 1, count[Ground] - 1
    freedom = 3 * moving - 2 * count[Revolute] - 3 * count[Rigid] - 3 * grounded
    if freedom != 1:
        remedy = "joints are missing" if freedom > 1 else "there are too many joints"
        raise GeometryError(
            f"linkage: 3 x {moving} bodies - 2 x {count[Revolute]} revolute - 3 x {count[Rigid]} rigid "
            f"- 3 x {grounded} grounded = {freedom} degrees of freedom, must be 1: {remedy}"
        )


def _loose_bodies(linkage: Linkage, mechanism: Mechanism, coordinates: Floats) -> list[str]:
    """Return the bodies that can move though the crank is held, from the null space of the Jacobian."""
    jacobian = mechanism.jacobian(coordinates)
    jacobian[:, 2::3] /= _length(linkage)  # so that turning counts like moving
    _, singular, directions = np.linalg.svd(jacobian)
    null = np.abs(directions[singular < RANK * singular[0]])
    moved = null.reshape(-1, len(mechanism.bodies), 3).max(axis=(0, 2), initial=0.0) > 1e-6
    return [body for body, moves in zip(mechanism.bodies, moved, strict=True) if moves]


def _length(linkage: Linkage) -> float:
    return float(np.mean([body.length_m for body in linkage.bodies if body.name != "ground"]))
