"""Positions and velocities of a mechanism whose drive is given, by Newton-Raphson, (4.14)-(4.17).

The contract of the solver. Start: the caller's, near enough that the joints are on the wanted side of their
dead points; the last solution led on by its velocity, where a mechanism is followed over a turn. Tolerance:
the largest Newton difference, `TOLERANCE` in metres and radians; convergence is quadratic, so the answer is
then as good as the arithmetic. Cap: `ITERATIONS`. Failure: :class:`SolutionError` with the numbers, never an
answer that is off. Cost: one linear system of all coordinates for each position and iteration, solved in one
call for a stack of them.
"""

import numpy as np

from hilplant.failure import Failure
from hilplant.mechanics.planar import Floats, Mechanism
from hilplant.units import RAD_PER_DEG

TOLERANCE = 1e-12
ITERATIONS = 20
#: Positions of a turn that are found one after the other; those between them start from these, all at once.
MARCHED = 64


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


def follow(mechanism: Mechanism, drive_rad: Floats) -> Floats:
    """Return the coordinates [m, n] along a row of drive angles [m] that begins at the design position."""
    stride = max(1, drive_rad.size // MARCHED)
    marched = _march(mechanism, drive_rad[::stride])
    nearest = np.arange(drive_rad.size) // stride
    ahead = drive_rad - drive_rad[::stride][nearest]
    start = marched[nearest] + rates(mechanism, marched)[nearest] * ahead[:, np.newaxis]
    result = positions(mechanism, start, drive_rad)
    _check_side(mechanism, result, drive_rad)
    return result


def _march(mechanism: Mechanism, drive_rad: Floats) -> Floats:
    """Solve one position after the other, each from the one before, led on by its velocity."""
    result = np.empty((drive_rad.size, mechanism.design.size))
    result[0] = positions(mechanism, mechanism.design, drive_rad[0])
    for knot in range(1, drive_rad.size):
        before = result[knot - 1]
        ahead = drive_rad[knot] - drive_rad[knot - 1]
        result[knot] = positions(mechanism, before + rates(mechanism, before) * ahead, drive_rad[knot])
    return result


def _check_side(mechanism: Mechanism, coordinates: Floats, drive_rad: Floats) -> None:
    """Refuse to fall through a dead point, the only place where the determinant changes its sign."""
    sign = np.linalg.slogdet(mechanism.jacobian(coordinates))[0]
    if (sign != sign[0]).any():
        knot = int(np.argmax(sign != sign[0]))
        raise SolutionError(
            f"a joint falls through its dead point at drive angle {_degrees(drive_rad, knot)} deg"
        )


def _solved(mechanism: Mechanism, coordinates: Floats, right_side: Floats, drive_rad: Floats) -> Floats:
    try:
        solved = np.linalg.solve(mechanism.jacobian(coordinates), right_side[..., np.newaxis])
    except np.linalg.LinAlgError:
        angles = f"{_degrees(drive_rad, 0)} to {_degrees(drive_rad, -1)} deg"
        raise SolutionError(f"the joints do not settle the positions for drive angles {angles}") from None
    return np.asarray(solved[..., 0])


def _degrees(drive_rad: Floats, index: int) -> str:
    return f"{np.atleast_1d(drive_rad)[index] / RAD_PER_DEG:.3f}"
