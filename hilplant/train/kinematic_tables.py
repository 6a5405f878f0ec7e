"""Look-up tables of positions, velocities and accelerations, section 6.2 of Dooner (2016), with a stated error.

The thesis tabulates positions and differentiates them in time. Here the table holds positions and their exact
derivatives by the crank angle, and so do those that are asked for: position p, velocity p' w, and acceleration
p'' w^2 + p' a, p'' again from a table of p'. The knots are as few as keep every one of them within the bound.
"""

from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.mechanics.motion import motion, point_motion
from hilplant.mechanics.wiper import Wiper
from hilplant.models.torque_samples import look_ups
from hilplant.units import TURN_RAD

FEWEST, MOST = 32, 65536

#: Where within an interval a cubic Hermite is farthest off: the value in the middle, the derivative beside it.
_WORST = (0.5, 0.5 - np.sqrt(3.0) / 6.0, 0.5 + np.sqrt(3.0) / 6.0)


@dataclass(frozen=True, slots=True)
class Curves:
    """Exact positions [m, quantities] and their first two derivatives by the crank angle."""

    position: Floats
    velocity: Floats
    acceleration: Floats


@dataclass(frozen=True, slots=True)
class TableErrors:
    """Largest error of one quantity between the knots, as part of the largest size of each kind, and where [rad]."""

    quantity: str
    position: float
    velocity: float
    acceleration: float
    worst_angle_rad: float

    @property
    def worst(self) -> float:
        """The greatest of the three."""
        return max(self.position, self.velocity, self.acceleration)


QUANTITIES = (
    "left_rocker_rad", "right_rocker_rad", "left_blade_x_m", "left_blade_y_m", "right_blade_x_m", "right_blade_y_m",
)  # fmt: skip


def exact(wiper: Wiper, crank_rad: Floats) -> Curves:
    """Return rockers and the blades' middle friction points, each position solved for itself."""
    moving = motion(wiper, crank_rad)
    angles = [wiper.mechanism.angle(side.rocker) for side in wiper.sides]
    points = [point_motion(wiper, moving, side.friction[len(side.friction) // 2]) for side in wiper.sides]
    return Curves(
        np.column_stack([moving.coordinates[:, angles], *(point.place for point in points)]),
        np.column_stack([moving.rates[:, angles], *(point.rate for point in points)]),
        np.column_stack([moving.accelerations[:, angles], *(point.acceleration for point in points)]),
    )


def table(wiper: Wiper, knots: int) -> Floats:
    """Return an array [knots + 1, 2 quantities, 2] as the step reads it: positions first, then velocities."""
    curves = exact(wiper, np.linspace(0.0, TURN_RAD, knots, endpoint=False))
    positions = np.stack([curves.position, curves.velocity], axis=-1)
    velocities = np.stack([curves.velocity, curves.acceleration], axis=-1)
    once = np.concatenate([positions, velocities], axis=1)
    return np.ascontiguousarray(np.concatenate([once, once[:1]]))


def errors_of(wiper: Wiper, rows: Floats) -> list[TableErrors]:
    """Compare what a table gives with exact positions, at the worst places of each interval."""
    knots = len(rows) - 1
    crank_rad = ((np.arange(knots)[:, np.newaxis] + np.array(_WORST)) * (TURN_RAD / knots)).ravel()
    truth, read = exact(wiper, crank_rad), look_up(rows, crank_rad)
    pairs = zip(astuple(read), astuple(truth), strict=True)
    away = [np.abs(ours - theirs) / np.abs(theirs).max(axis=0) for ours, theirs in pairs]
    found = []
    for column, quantity in enumerate(QUANTITIES):
        position, velocity, acceleration = (kind[:, column] for kind in away)
        worst = int(np.max([position, velocity, acceleration], axis=0).argmax())
        sizes = [float(kind.max()) for kind in (position, velocity, acceleration)]
        found.append(TableErrors(quantity, sizes[0], sizes[1], sizes[2], float(crank_rad[worst])))
    return found


def look_up(rows: Floats, crank_rad: Floats) -> Curves:
    """Return what a table gives at crank angles in [0, 2 pi), through the look-up of the step."""
    count = rows.shape[1] // 2
    read = np.empty((len(crank_rad), rows.shape[1], 2))
    look_ups(rows, crank_rad, read)
    return Curves(read[:, :count, 0], read[:, count:, 0], read[:, count:, 1])


def within(wiper: Wiper, bound: float) -> tuple[Floats, list[TableErrors]]:
    """Return the table with the fewest knots, a power of two, whose errors are within a bound, and its errors.

    Raises
    ------
    Failure
        When even the most knots do not keep it: the positions themselves are solved to about 1e-12.

    """
    knots, worst = FEWEST, 1.0
    while knots <= MOST:
        rows = table(wiper, knots)
        found = errors_of(wiper, rows)
        worst = max(error.worst for error in found)
        if worst <= bound:
            return rows, found
        knots *= 2
    text = f"keeps within {bound:g} of the exact values; the last has {worst:.2g}"
    raise Failure(f"no table of up to {MOST} knots {text}")


def write_csv(rows: Floats, path: Path) -> None:
    """Write a table: angle, then position, first and second derivative by the crank angle of each quantity."""
    count = rows.shape[1] // 2
    names = [f"{name}{kind}" for name in QUANTITIES for kind in ("", "_per_rad", "_per_rad2")]
    body = np.column_stack([np.column_stack([rows[:, k], rows[:, count + k, 1]]) for k in range(count)])
    angle = np.linspace(0.0, TURN_RAD, len(rows))
    head = ",".join(["crank_angle_rad", *names])
    np.savetxt(path, np.column_stack([angle, body]), delimiter=",", header=head, comments="", fmt="%.17g")
