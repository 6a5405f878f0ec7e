"""The friction of a bench's blades over their speed, and the speeds that they have in a turn: Figures 4-22 and 4-26."""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench, load_bench
from hilplant.mechanics.motion import motion, point_motion
from hilplant.models.friction import coefficient
from hilplant.models.records import Friction
from hilplant.models.reduced import MM_PER_M
from hilplant.resources import shipped
from hilplant.simulation.crank_torque import WETNESS
from hilplant.units import TURN_RAD


class FrictionSet(NamedTuple):
    """A set of friction coefficients by its name, and the force [N] on the blade at which it is drawn."""

    name: str
    curve: Friction
    force_n: float


class BladeSpeeds(NamedTuple):
    """Speeds of the fastest and of a typical point of both blades over a turn [mm/s]: largest and median."""

    median_mm_s: float
    largest_mm_s: float


#: Force [N] of each wet set in Table 4-2.
TABLE_4_2_N = (10.0, 10.0, 10.0, 10.0, 10.0, 15.0)


def mu_over_speed(found: FrictionSet, wetness: float, speeds_mm_s: Floats) -> Floats:
    """Return the coefficient of friction at each speed [mm/s], as the step computes it."""
    return np.array([coefficient(float(speed), wetness, found.force_n, found.curve)[0] for speed in speeds_mm_s])


def bench_friction(bench: Bench) -> FrictionSet:
    """Return the friction of a bench at the force of its left blade."""
    load = bench.parameters.load
    return FrictionSet(bench.name, load.friction, load.left_blade.force_n)


def published_sets(screen: str) -> list[FrictionSet]:
    """Return the sets of Table 4-1 (`screen` dry) or Table 4-2 (wet) from the shipped screens, at the forces there."""
    table, forces = ("table_4_1", (10.0,) * 4) if screen == "dry" else ("table_4_2", TABLE_4_2_N)
    found = []
    for number, force in enumerate(forces, start=1):
        path = shipped("config", "screens", f"{table}_friction_{number}.yaml")
        bench = load_bench(f"extends: default.yaml\nplant:\n  screen: {path}\n")
        found.append(FrictionSet(f"Friction {number}", bench.parameters.load.friction, force))
    return found


def blade_speeds(bench: Bench, crank_speed_rad_s: float) -> BladeSpeeds:
    """Return how fast the friction points of both blades go over a turn at an even speed of the crank."""
    wiper = bench.plant.mechanics.wiper
    moving = motion(wiper, np.linspace(0.0, TURN_RAD, 720, endpoint=False))
    ways = [point_motion(wiper, moving, pin).rate for side in wiper.sides for pin in side.friction]
    speeds = MM_PER_M * abs(crank_speed_rad_s) * np.linalg.norm(np.concatenate(ways), axis=1)
    return BladeSpeeds(float(np.median(speeds)), float(speeds.max()))


def friction_columns(bench: Bench, speeds_mm_s: Floats) -> dict[str, Floats]:
    """Return speed and the bench's coefficients on a dry, tacky and wet screen."""
    found = bench_friction(bench)
    return {"speed_mm_s": speeds_mm_s} | {
        f"mu_{name}": mu_over_speed(found, wetness, speeds_mm_s) for name, wetness in WETNESS.items()
    }
