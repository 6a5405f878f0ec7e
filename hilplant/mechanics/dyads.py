"""A linkage taken apart into pairs of bodies that settle each other, beginning at ground and crank.

Two bodies that meet in a joint, each of them pinned to something whose place is already settled, form a dyad: both
follow from where their outer pins are, and are then settled themselves.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.mechanics.linkage import Linkage
from hilplant.mechanics.planar import Ground, Mechanism, Pin, Revolute, Rigid


@dataclass(frozen=True, slots=True)
class Dyad:
    """Two bodies that share a joint, and the pins by which each hangs on what is settled before them."""

    joint: Pin
    first_outer: Pin
    second_outer: Pin
    bodies: tuple[str, str]

    def angle_rad(self, mechanism: Mechanism, coordinates: Floats) -> Floats:
        """Return the transmission angle [rad], in [0, pi]."""
        joint, first, second = (
            mechanism.point(coordinates, pin) for pin in (self.joint, self.first_outer, self.second_outer)
        )
        ways = first - joint, second - joint
        cross = ways[0][..., 0] * ways[1][..., 1] - ways[0][..., 1] * ways[1][..., 0]
        return np.asarray(np.arctan2(np.abs(cross), (ways[0] * ways[1]).sum(axis=-1)))


def taken_apart(linkage: Linkage) -> tuple[list[Dyad], list[str]]:
    """Return the dyads in the order in which they settle, and the names of bodies that are in none."""
    groups = _rigid_groups(linkage)
    settled = {groups["ground"], groups[linkage.crank]}
    found: list[Dyad] = []
    while (dyad := next(_dyads(linkage, groups, settled), None)) is not None:
        found.append(dyad)
        settled |= {groups[body] for body in dyad.bodies}
    return found, [body for body in groups if groups[body] not in settled]


def _dyads(linkage: Linkage, groups: Mapping[str, str], settled: set[str]) -> Iterator[Dyad]:
    """Yield the dyads that hang on settled bodies with both outer pins."""
    hinges = [joint for joint in linkage.joints if isinstance(joint, Revolute)]
    outer: dict[str, Pin] = {}
    for hinge in hinges:
        for own, other in ((hinge.first, hinge.second), (hinge.second, hinge.first)):
            if groups[other[0]] in settled and groups[own[0]] not in settled:
                outer[groups[own[0]]] = own
    for hinge in hinges:
        first, second = groups[hinge.first[0]], groups[hinge.second[0]]
        if first != second and first in outer and second in outer:
            yield Dyad(hinge.first, outer[first], outer[second], (hinge.first[0], hinge.second[0]))


def _rigid_groups(linkage: Linkage) -> dict[str, str]:
    """Return a name for each body that it shares with those to which it is rigidly joined."""
    groups = {body.name: body.name for body in linkage.bodies}
    for joint in linkage.joints:
        if isinstance(joint, Rigid | Ground):
            pair = (joint.first[0], joint.second[0]) if isinstance(joint, Rigid) else ("ground", joint.body)
            kept, given = groups[pair[0]], groups[pair[1]]
            groups = {body: kept if group == given else group for body, group in groups.items()}
    return groups
