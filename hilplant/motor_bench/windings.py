"""Torque and back-EMF constants of a motor from its magnets, coils and brushes, section 3.3 of Dooner (2016).

Two magnets give an even radial field, (3.13). A coil has its two sides `pitch_slots` apart: it has a back-EMF while
they lie under different magnets, none while they lie under the same one, and one of the other sign beyond the neutral
line. The brushes part the coils into two current paths. What is counted here is which coil is where, at evenly spread
positions of the rotor over one slot.

The thesis adds up all coils of both paths: 10 K_t for the slow brush, (3.11) and (3.27), 8 K_t for the fast one, (3.12)
and (3.28). The two paths are parallel. So the back-EMF between the brushes is half of that sum, and so is the torque of
an ampere of the brush: it is this half that (3.30) and (3.31) need. The ratio of the two brushes is the same.

Left out: saturation, armature reaction, leakage between the magnets' edges, the coils that a brush shorts, its width.
"""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.motor_bench.readings import Windings
from hilplant.units import RAD_PER_DEG, TURN_RAD

#: Positions of the rotor over one slot at which coils are counted.
POSITIONS = 3600


class Armature(NamedTuple):
    """The rotor: coils (as many as slots), slots from one side of a coil to the other, angle between the brushes [deg].

    `fast_brush_deg` is how far the fast brush stands from the slow one; the slow one is opposite the common brush.
    """

    coils: int
    pitch_slots: int
    fast_brush_deg: float

    @classmethod
    def of(cls, windings: Windings) -> "Armature":
        """Return that of a file of windings."""
        return cls(windings.coils, windings.pitch_slots, windings.fast_brush_deg)


class BrushSum(NamedTuple):
    """Coils that count for one brush: the thesis' sum of both paths, its least and most, and what the brush sees."""

    mean: float
    least: float
    most: float

    @property
    def between_brushes(self) -> float:
        """The constant at the brushes over that of one coil: two paths are parallel, so half of the sum."""
        return self.mean / 2.0


def coil_constant_v_s(flux_density_t: float, length_m: float, diameter_m: float, turns: int = 1) -> float:
    """Return K_t = l1 l2 B of one coil, (3.6), equal to K_e of (3.20) [V s/rad or N m/A]."""
    return turns * length_m * diameter_m * flux_density_t


def counted(armature: Armature, fast: bool) -> BrushSum:
    """Return how many coils count, their signs taken, for the slow or the fast brush.

    A coil that carries current against its back-EMF counts as -1, coil 4 of (3.26); one under a single magnet as 0,
    coils 1 and 12 of (3.22) and (3.24).
    """
    slot = TURN_RAD / armature.coils
    rotor = (np.arange(POSITIONS) + 0.5) * slot / POSITIONS
    centre = rotor[:, np.newaxis] + slot * np.arange(armature.coils)
    sums = (emf_sign(centre, armature) * path_sign(centre, armature, fast)).sum(axis=1)
    return BrushSum(float(sums.mean()), float(sums.min()), float(sums.max()))


def emf_sign(centre_rad: Floats, armature: Armature) -> Floats:
    """Return 1, 0 or -1 for coils with their axis at these angles from the neutral line."""
    half = 0.5 * armature.pitch_slots * TURN_RAD / armature.coils
    # A side is under the north magnet within half a turn of the neutral line.
    ahead, behind = (np.sign(np.sin(centre_rad + side - TURN_RAD / 4.0)) for side in (half, -half))
    return np.asarray(0.5 * (ahead - behind))


def path_sign(centre_rad: Floats, armature: Armature, fast: bool) -> Floats:
    """Return 1 for coils of current path one, -1 for those of path two."""
    begin = armature.fast_brush_deg * RAD_PER_DEG if fast else 0.0
    angle = np.mod(centre_rad, TURN_RAD)
    return np.where((angle >= begin) & (angle < TURN_RAD / 2.0), 1.0, -1.0)


def path_resistance(armature: Armature, fast: bool) -> float:
    """Return the resistance between the brushes over that of one coil, Figure 3-9: two paths in parallel.

    A path of n coils beside one of N - n has n (N - n)/N of a coil's resistance, most with n = N/2: so the slow brush's
    is the greater one, (3.32). The same ratio holds for inductances as far as coils do not share their flux.
    """
    slot = TURN_RAD / armature.coils
    rotor = (np.arange(POSITIONS) + 0.5) * slot / POSITIONS
    centre = rotor[:, np.newaxis] + slot * np.arange(armature.coils)
    first = (path_sign(centre, armature, fast) > 0.0).sum(axis=1)
    return float(np.mean(first * (armature.coils - first) / armature.coils))


def brush_constants_v_s(windings: Windings) -> tuple[float, float]:
    """Return the constants of (3.30) and (3.31), slow and fast [V s/rad], for the current of the brush."""
    size = windings.flux_density_t, windings.armature_length_m, windings.armature_diameter_m
    coil, armature = coil_constant_v_s(*size, windings.turns), Armature.of(windings)
    slow, fast = (coil * counted(armature, brush).between_brushes for brush in (False, True))
    return slow, fast
