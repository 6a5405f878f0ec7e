"""A second truth for the kinematics: joints found by letting two circles meet, in complex numbers.

It knows nothing of bodies, coordinates, constraints or iterations. One linkage or a stack of linkages is solved at
once: points may be arrays [m, 1], crank angles [k] or [m, k].
"""

from collections.abc import Callable, Mapping
from functools import reduce
from typing import Any

import numpy as np
import pytest
import yaml

from hilplant.arrays import Floats
from hilplant.mechanics.centre_driven import centre_driven
from hilplant.mechanics.linkage import Linkage
from hilplant.mechanics.master_driven import master_driven
from hilplant.mechanics.slave_driven import slave_driven
from hilplant.resources import shipped

Points = Mapping[str, Any]
MAKERS = {"slave_driven": slave_driven, "master_driven": master_driven, "centre_driven": centre_driven}
CONFIGURATIONS = [f"{hand}_{kind}" for hand in ("rhd", "lhd") for kind in MAKERS]


class Circles:
    """One kind of linkage by circles; `reach` and `angles` are not-a-number where they do not meet."""

    def __init__(self, kind: str, points: Points, crank_rad: Floats) -> None:
        at = {name: np.asarray(point) for name, point in points.items()}
        self.gaps: list[tuple[Any, Any, Any]] = []
        o, a, b, c = (at[name] for name in "OABC")
        pin = o + (a - o) * np.exp(1j * np.asarray(crank_rad))
        joint = self._meeting((pin, a), b, c)
        if kind == "slave_driven":
            d, (e, f) = self._meant(b, c, at["D"]), (at["E"], at["F"])
            carried = c + (d - c) / (b - c) * (joint - c)
            last = self._meeting((carried, at["D"]), e, f)
        else:
            e, f = at["D"], at["E"]
            last = self._meeting((joint, b) if kind == "master_driven" else (pin, a), e, f)
        self.angles = np.stack([np.angle(c - joint), np.angle(f - last)])

    @staticmethod
    def _meant(b: Any, c: Any, d: Any) -> Any:
        """Return D on the line from C to B where it is less than 0.1 mm beside it, as (4.10) has it."""
        unit = (b - c) / np.abs(b - c)
        along = (d - c) / unit
        return np.where(np.abs(along.imag) <= 1e-4, c + np.sign(along.real) * np.abs(along) * unit, d)

    def _meeting(self, moved: tuple[Any, Any], joint: Any, pivot: Any) -> Any:
        """Return where the joint goes when its first centre has moved, on the side where it was."""
        centre, written = moved
        radius, other = np.abs(joint - written), np.abs(joint - pivot)
        distance = np.abs(pivot - centre)
        self.gaps.append((distance, np.abs(radius - other), radius + other))
        along = (distance**2 + radius**2 - other**2) / (2.0 * distance)
        with np.errstate(invalid="ignore"):
            across = np.sign(((pivot - written).conj() * (joint - written)).imag) * np.sqrt(radius**2 - along**2)
            return centre + (pivot - centre) / distance * (along + 1j * across)

    @property
    def spare(self) -> Floats:
        """How far the circles are from missing each other [m], negative where they do."""
        return np.asarray(reduce(np.minimum, [np.minimum(gap - low, high - gap) for gap, low, high in self.gaps]))


def complex_points(written: Mapping[str, Any]) -> dict[str, complex]:
    return {name: complex(*at[:2]) for name, at in written.items()}


def configuration(name: str) -> dict[str, Any]:
    return dict(yaml.safe_load(shipped("config", "linkages", f"{name}.yaml").read_text()))


@pytest.fixture(scope="session")
def circles() -> Callable[[str, Points, Floats], Circles]:
    return Circles


@pytest.fixture(params=CONFIGURATIONS)
def written(request: pytest.FixtureRequest) -> dict[str, Any]:
    """Each of the six shipped linkages in turn, as its file says it."""
    return configuration(request.param)


@pytest.fixture
def linkage(written: dict[str, Any]) -> Linkage:
    return MAKERS[written["kind"]](written["points_m"])


@pytest.fixture
def placed(written: dict[str, Any]) -> dict[str, complex]:
    return complex_points(written["points_m"])


@pytest.fixture(scope="session")
def makers() -> Mapping[str, Callable[[Mapping[str, Any]], Linkage]]:
    return MAKERS
