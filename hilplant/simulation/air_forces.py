"""Drag and lift on a blade over the vehicle's speed, (4.51) and (4.52): Figure 4-30."""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench
from hilplant.mechanics.coefficients import coefficient_over
from hilplant.mechanics.motion import motion
from hilplant.mechanics.wiper import AIR_DENSITY_KG_M3
from hilplant.units import TURN_RAD


class AirSet(NamedTuple):
    """A blade in the wind: area [m2], drag and lift coefficients, each lowest and highest over the arm's sweep."""

    name: str
    area_m2: float
    drag: tuple[float, float]
    lift: tuple[float, float]
    density_kg_m3: float = AIR_DENSITY_KG_M3

    def forces_n(self, coefficient: float, speeds_m_s: Floats) -> Floats:
        """Return the force [N] of a coefficient at each speed."""
        return np.asarray(0.5 * self.density_kg_m3 * speeds_m_s**2 * self.area_m2 * coefficient)


#: Section 4.5: derived there from measurements of others, with a spoiler and without.
PUBLISHED = (
    AirSet("without spoiler, 4.5", 0.07, (0.175, 0.175), (0.0517, 0.0517)),
    AirSet("with spoiler, 4.5", 0.07, (0.219, 0.219), (-0.0694, -0.0694)),
)


def bench_air(bench: Bench) -> list[AirSet]:
    """Return both blades of a bench."""
    wiper = bench.plant.mechanics.wiper
    moving = motion(wiper, np.linspace(0.0, TURN_RAD, 720, endpoint=False))
    found = []
    for side in wiper.sides:
        arm_rad = moving.coordinates[:, wiper.mechanism.angle(side.rocker)] + side.arm.offset_rad
        drag, lift = (
            coefficient_over(f"{side.name} blade: {word}", written, arm_rad)[0]
            for word, written in (("drag", side.air.drag), ("lift", side.air.lift))
        )
        limits = [(float(values.min()), float(values.max())) for values in (drag, lift)]
        name = f"{bench.name}, {side.name}"
        found.append(AirSet(name, side.air.area_m2, limits[0], limits[1], wiper.air_density_kg_m3))
    return found


def air_columns(bench: Bench, speeds_m_s: Floats) -> dict[str, Floats]:
    """Return speed, and drag and lift [N] of the published blades and the bench's, at the highest coefficients."""
    found = {"vehicle_speed_m_s": speeds_m_s}
    for each in (*PUBLISHED, *bench_air(bench)):
        word = each.name.replace(", ", "_").replace(" ", "_").replace(".", "_")
        found[f"{word}_drag_n"] = each.forces_n(each.drag[1], speeds_m_s)
        found[f"{word}_lift_n"] = each.forces_n(each.lift[1], speeds_m_s)
    return found
