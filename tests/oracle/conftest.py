"""Whole wipers for the tests of the dynamics, put together from the shipped linkages with assumed masses."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import yaml

from hilplant.mechanics.arms import arm_points
from hilplant.mechanics.blades import blade_tips
from hilplant.mechanics.centre_driven import centre_driven
from hilplant.mechanics.coefficients import Aerodynamics
from hilplant.mechanics.master_driven import master_driven
from hilplant.mechanics.slave_driven import slave_driven
from hilplant.mechanics.wiper import SideParts, WiperParts
from hilplant.resources import shipped

MAKERS = {"slave_driven": slave_driven, "master_driven": master_driven, "centre_driven": centre_driven}
#: Published for bodies 2 to 6; those of arms and blades are assumed, and differ to tell left from right.
MASSES_KG = {"crank": 0.0845, "coupler": 0.3835, "left_rocker": 0.1157, "link": 0.6370, "right_rocker": 0.0780}
LINKAGES = [f"{hand}_{kind}" for hand in ("rhd", "lhd") for kind in MAKERS]


def parts_of(name: str) -> WiperParts:
    written = yaml.safe_load(shipped("config", "linkages", f"{name}.yaml").read_text())
    linkage = MAKERS[written["kind"]](written["points_m"])
    left = _side(written, "left", SideParts((), None, 0.5, 0.3, Aerodynamics(0.07, 0.175, 0.0517)))
    right = _side(written, "right", SideParts((), None, 0.45, 0.25, Aerodynamics(0.06, 0.219, -0.0694)))
    return WiperParts(linkage, left, right, MASSES_KG, screen_angle_rad=-0.57)


def _side(written: dict[str, Any], name: str, side: SideParts) -> SideParts:
    arm = arm_points(written[f"{name}_arm"]["kind"], written[f"{name}_arm"]["points_m"])
    return replace(side, arm=arm, blade=blade_tips(written[f"{name}_blade"]["points_m"]))


def shaken_parts(random: np.random.Generator) -> WiperParts:
    """Return a wiper of random proportions and masses, on one of the shipped linkages, near enough to turn."""
    parts = parts_of(str(random.choice(LINKAGES)))
    linkage = parts.linkage
    points = {name: list(np.array(at) + random.normal(0.0, 0.002, 2)) for name, at in linkage.points.items()}
    return WiperParts(
        MAKERS[linkage.kind](points),
        _shaken_side(random),
        _shaken_side(random),
        masses_kg={name: float(random.uniform(0.0, 1.0)) for name in MASSES_KG},
        screen_angle_rad=float(random.uniform(-1.2, 1.2)),
        pivot_damping_n_m_s=float(random.uniform(0.0, 0.3)),
        points=int(random.integers(1, 5)),
    )


def _shaken_side(random: np.random.Generator) -> SideParts:
    steps = np.cumsum(random.normal(0.0, 0.3, (int(random.integers(1, 5)), 2)), axis=0)
    row = [(0.0, 0.0), *((float(x), float(y)) for x, y in steps)]
    first, second = ((float(x), float(y)) for x, y in random.normal(0.0, 0.4, (2, 2)))
    arm_kg, blade_kg = (float(mass) for mass in random.uniform(0.0, 1.0, 2))
    return SideParts(tuple(row), (first, second), arm_kg, blade_kg, Aerodynamics(0.05, 0.2, 0.05))


@pytest.fixture(scope="session")
def shipped_parts() -> Callable[[str], WiperParts]:
    """Return a wiper by the name of its shipped linkage."""
    return parts_of


@pytest.fixture(scope="session")
def random_parts() -> Callable[[np.random.Generator], WiperParts]:
    return shaken_parts


@pytest.fixture(scope="session", params=LINKAGES)
def every_parts(request: pytest.FixtureRequest) -> WiperParts:
    """Each of the six shipped linkages in turn."""
    return parts_of(request.param)
