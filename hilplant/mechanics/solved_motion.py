"""Position, velocity and acceleration of every body at an even crank speed: "solve system" of 4.2.4 and 8.3.2."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.mechanics.motion import Motion, PointMotion, motion, point_motion
from hilplant.mechanics.planar import Pin
from hilplant.mechanics.wiper import Wiper
from hilplant.units import TURN_RAD

#: More instants than this are refused: each is solved for itself.
MOST_INSTANTS = 200_000
_AXES = (("x", "m"), ("y", "m"), ("angle", "rad"))


@dataclass(frozen=True, slots=True)
class Track:
    """Columns [m] of one body or point: positions, velocities and accelerations by name, with the unit in the name."""

    name: str
    position: dict[str, Floats]
    velocity: dict[str, Floats]
    acceleration: dict[str, Floats]


@dataclass(frozen=True, slots=True)
class SolvedMotion:
    """Instants [s] [m], crank angles [rad], and the tracks of all moving bodies and of the blades' joints and tips."""

    time_s: Floats
    crank_rad: Floats
    tracks: tuple[Track, ...]

    def track(self, name: str) -> Track:
        """Return one track.

        Raises
        ------
        Failure
            When there is none of that name.

        """
        found = {track.name: track for track in self.tracks}
        if name not in found:
            raise Failure(f"there is no body {name!r}; there are {', '.join(found)}")
        return found[name]

    def columns(self) -> dict[str, Floats]:
        """Return time, crank angle, and every column as BODY_QUANTITY."""
        found = {"time_s": self.time_s, "crank_rad": self.crank_rad}
        for track in self.tracks:
            for part in (track.position, track.velocity, track.acceleration):
                found |= {f"{track.name}_{name}": values for name, values in part.items()}
        return found


def solve_motion(
    wiper: Wiper, crank_speed_rad_s: float, seconds: float, step_s: float, start_rad: float = 0.0
) -> SolvedMotion:
    """Turn the crank evenly from `start_rad`, 0 being park, and solve each instant by Newton-Raphson, (4.17)-(4.19).

    Raises
    ------
    Failure
        For a duration or a step that is not above 0, and for more than `MOST_INSTANTS`.
    SolutionError
        When a position is not found.

    """
    if not (seconds > 0.0 and step_s > 0.0):
        raise Failure(f"duration and step must be above 0, not {seconds:g} s and {step_s:g} s")
    if seconds / step_s > MOST_INSTANTS:
        raise Failure(f"{seconds:g} s in steps of {step_s:g} s are more than {MOST_INSTANTS} instants")
    time_s: Floats = np.arange(int(seconds / step_s + 1e-9) + 1, dtype=np.float64) * step_s
    moving = _counted_on(wiper, motion(wiper, start_rad + crank_speed_rad_s * time_s))
    tracks = [_body(wiper, name, moving, crank_speed_rad_s) for name in _moving_bodies(wiper)]
    for name, pin in blade_points(wiper):
        tracks.append(_point(name, point_motion(wiper, moving, pin), crank_speed_rad_s))
    return SolvedMotion(time_s, moving.crank_rad, tuple(tracks))


def _counted_on(wiper: Wiper, moving: Motion) -> Motion:
    """Count angles of bodies that go round on over whole turns of the crank, as time goes on."""
    gained = np.round((wiper.turn.coordinates[-1] - wiper.turn.coordinates[0]) / TURN_RAD) * TURN_RAD
    turns = np.floor(moving.crank_rad / TURN_RAD)
    coordinates = moving.coordinates.copy()
    coordinates[:, : len(gained)] += turns[:, np.newaxis] * gained
    return replace(moving, coordinates=coordinates)


def blade_points(wiper: Wiper) -> list[tuple[str, Pin]]:
    """Return the joint and both tips of each blade; of a bare arm its end."""
    found: list[tuple[str, Pin]] = []
    for side in wiper.sides:
        found.append((f"{side.name}_blade_joint", side.centre))
        found += [(f"{side.name}_tip_{letter}", tip) for letter, tip in zip("ab", side.tips, strict=False)]
    return found


def _moving_bodies(wiper: Wiper) -> Sequence[str]:
    return [body.name for body in wiper.bodies if body.name != "ground"]


def _body(wiper: Wiper, name: str, moving: Motion, speed: float) -> Track:
    first = 3 * wiper.mechanism.bodies[name]
    columns = slice(first, first + 3)
    return Track(
        name,
        _named(moving.coordinates[:, columns], ""),
        _named(moving.rates[:, columns] * speed, "_s"),
        _named(moving.accelerations[:, columns] * speed**2, "_s2"),
    )


def _point(name: str, found: PointMotion, speed: float) -> Track:
    parts = (found.place, ""), (found.rate * speed, "_s"), (found.acceleration * speed**2, "_s2")
    return Track(name, *(_named(values, per) for values, per in parts))


def _named(values: Floats, per: str) -> dict[str, Floats]:
    """Name the columns x, y and angle of an array [m, 2 or 3] with their unit; `per` is what follows it."""
    return {f"{axis}_{unit}{per}": values[:, index] for index, (axis, unit) in enumerate(_AXES[: values.shape[1]])}
