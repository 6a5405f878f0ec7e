"""Positions, velocities and accelerations of a mechanism whose drive is given, (4.14)-(4.23).

The contract of the solver. Start: the caller's, near enough that the joints are on the wanted side of their
dead points; the last solution led on by its velocity where a mechanism is followed, in steps that are halved near
dead points. Tolerance: the largest Newton difference, `TOLERANCE` in metres and radians; convergence is quadratic,
so the answer is then as good as the arithmetic. Cap: `ITERATIONS`. Failure: :class:`SolutionError` with the
numbers, never an answer that is off. Cost: one linear system of all coordinates for each position and iteration,
solved in one call for a stack of them.
"""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.mechanics.planar import Mechanism
from hilplant.units import RAD_PER_DEG

TOLERANCE = 1e-12
ITERATIONS = 20
#: Positions of a turn that are found one after the other; those between them start from these, all at once.
MARCHED = 64
#: How often a step of the march is halved when it leads astray; the last ones are 1e-3 deg for a march of a turn.
HALVINGS = 12
#: A body's speed changes by less than this share within a step, unless joints fell through dead points.
ABRUPT = 0.5


class SolutionError(Failure):
    """The joints cannot be brought together, or not on the side of their dead points where they began."""


def positions(mechanism: Mechanism, start: Floats, drive_rad: Floats) -> Floats:
    """Return the coordinates at which all constraints hold.

    Parameters
    ----------
    mechanism
        The bodies and joints.
    start
        Where to begin, one position [n] or a stack [m, n].
    drive_rad
        Angle of the driven body [rad], one for each position.

    """
    coordinates = start
    for _ in range(ITERATIONS):
        residual = mechanism.constraints(coordinates, drive_rad)
        difference = _solved(mechanism, coordinates, -residual, drive_rad)  # (4.15)
        coordinates = coordinates + difference  # (4.16)
        if np.abs(difference).max() <= TOLERANCE:
            return coordinates
    moving = np.abs(difference).max(axis=-1)
    worst = int(np.argmax(moving))
    raise SolutionError(
        f"Newton-Raphson has not converged at drive angle {_degrees(drive_rad, worst)} deg: "
        f"after {ITERATIONS} steps it still moves by {moving.max():.3g} m or rad, wanted {TOLERANCE:.0e}"
    )


def rates(mechanism: Mechanism, coordinates: Floats) -> Floats:
    """Return the derivative of all coordinates by the drive angle, (4.17) at unit speed of the drive."""
    drive = np.broadcast_to(mechanism.drive, coordinates.shape)
    driven = coordinates[..., mechanism.angle(mechanism.driven)]
    return _solved(mechanism, coordinates, drive, driven)


def accelerations(
    mechanism: Mechanism, coordinates: Floats, speed_rad_s: float = 1.0, acceleration_rad_s2: float = 0.0
) -> Floats:
    """Return the second derivative of all coordinates by time, (4.19), (4.20).

    Parameters
    ----------
    mechanism
        The bodies and joints.
    coordinates
        A solution of :func:`positions`, [n] or [m, n].
    speed_rad_s, acceleration_rad_s2
        Of the driven body. Left out, the result is the second derivative by the drive angle.

    """
    velocities = rates(mechanism, coordinates) * speed_rad_s
    right_side = mechanism.turning(coordinates, velocities) + mechanism.drive * acceleration_rad_s2
    return _solved(mechanism, coordinates, right_side, coordinates[..., mechanism.angle(mechanism.driven)])


def follow(mechanism: Mechanism, drive_rad: Floats) -> Floats:
    """Return the coordinates [m, n] along a row of drive angles [m] that begins at the design position."""
    try:
        return _follow(mechanism, drive_rad, max(1, drive_rad.size // MARCHED))
    except SolutionError:
        return _follow(mechanism, drive_rad, 1)


def follow_as_far(mechanism: Mechanism, drive_rad: Floats) -> tuple[int, Floats]:
    """Return the place of the last drive angle [m] that can be reached, and the coordinates [n] there."""
    knot, coordinates = 0, positions(mechanism, mechanism.design, drive_rad[0])
    for stride in (max(1, drive_rad.size // MARCHED), 1):
        while knot + stride < drive_rad.size:
            try:
                coordinates = _advanced(mechanism, coordinates, float(drive_rad[knot + stride]), HALVINGS)
            except SolutionError:
                break
            knot += stride
    return knot, coordinates


def _follow(mechanism: Mechanism, drive_rad: Floats, stride: int) -> Floats:
    """Solve one position in so many after the one before, and those between them from these, all at once."""
    marched = _march(mechanism, drive_rad[::stride])
    nearest = np.arange(drive_rad.size) // stride
    ahead, side = drive_rad - drive_rad[::stride][nearest], _side(mechanism, marched)
    start = marched[nearest] + side.rates[nearest] * ahead[:, np.newaxis]
    result = positions(mechanism, start, drive_rad)
    _check_side(_Side(side.sign[nearest], side.rates[nearest]), _side(mechanism, result), drive_rad)
    return result


def _march(mechanism: Mechanism, drive_rad: Floats) -> Floats:
    """Solve one position after the other."""
    result = np.empty((drive_rad.size, mechanism.design.size))
    result[0] = positions(mechanism, mechanism.design, drive_rad[0])
    for knot in range(1, drive_rad.size):
        result[knot] = _advanced(mechanism, result[knot - 1], float(drive_rad[knot]), HALVINGS)
    return result


def _advanced(mechanism: Mechanism, before: Floats, drive_rad: float, halvings: int) -> Floats:
    """Solve a position from the one before it, led on by its velocity; in two steps where one leads astray."""
    from_rad = float(before[mechanism.angle(mechanism.driven)])
    try:
        side = _side(mechanism, before)
        found = positions(mechanism, before + side.rates * (drive_rad - from_rad), np.array(drive_rad))
        _check_side(side, _side(mechanism, found), np.array(drive_rad))
    except SolutionError:
        if halvings == 0:
            raise _dead_point(drive_rad) from None
        middle = _advanced(mechanism, before, (from_rad + drive_rad) / 2.0, halvings - 1)
        return _advanced(mechanism, middle, drive_rad, halvings - 1)
    return found


class _Side(NamedTuple):
    """On which side of dead points a mechanism is, and how it moves there; or a stack of both."""

    sign: Floats
    rates: Floats


def _side(mechanism: Mechanism, coordinates: Floats) -> _Side:
    sign = np.linalg.slogdet(mechanism.jacobian(coordinates))[0]
    return _Side(np.asarray(sign), rates(mechanism, coordinates))


def _check_side(before: _Side, after: _Side, drive_rad: Floats) -> None:
    """Refuse to fall through a dead point between positions.

    There the determinant of the Jacobian changes its sign. When two joints fall through at once it does not, and in
    a change point it need not; but then the velocities change abruptly.
    """
    speeds = np.abs([before.rates[..., 2::3], after.rates[..., 2::3]]).max(axis=(0, -1))
    change = np.abs(after.rates[..., 2::3] - before.rates[..., 2::3]).max(axis=-1)
    wrong = np.atleast_1d((before.sign != after.sign) | (change > ABRUPT * np.maximum(1.0, speeds)))
    if wrong.any():
        raise _dead_point(float(np.atleast_1d(drive_rad)[int(np.argmax(wrong))]))


def _dead_point(drive_rad: float) -> SolutionError:
    return SolutionError(f"a joint comes to its dead point at drive angle {drive_rad / RAD_PER_DEG:.3f} deg")


def _solved(mechanism: Mechanism, coordinates: Floats, right_side: Floats, drive_rad: Floats) -> Floats:
    try:
        solved = np.linalg.solve(mechanism.jacobian(coordinates), right_side[..., np.newaxis])
    except np.linalg.LinAlgError:
        angles = f"{_degrees(drive_rad, 0)} to {_degrees(drive_rad, -1)} deg"
        raise SolutionError(f"the joints do not settle the positions for drive angles {angles}") from None
    return np.asarray(solved[..., 0])


def _degrees(drive_rad: Floats, index: int) -> str:
    return f"{np.atleast_1d(drive_rad)[index] / RAD_PER_DEG:.3f}"
