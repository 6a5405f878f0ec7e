"""Planar rigid bodies, the joints between them, and where the joints put them.

Each body has three coordinates, the position of its origin and its angle, (4.1)-(4.3). Every constraint of
the thesis' section 4.2 is linear in these coordinates and in the cosines and sines of the angles, (4.4),
(4.5). So a mechanism is four constant matrices, filled joint by joint, and its Jacobian follows from them
without further algebra; evaluation works on one position or on a stack of them alike.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats

Point = tuple[float, float]
Pin = tuple[str, Point]


@dataclass(frozen=True, slots=True)
class Body:
    """A body as it stands at the design position: its origin [m], its angle from +X [rad], its length [m]."""

    name: str
    origin_m: Point
    angle_rad: float
    length_m: float

    @classmethod
    def between(cls, name: str, first: Point, second: Point) -> "Body":
        """Lay a body between two points: origin half-way, own +X from the first to the second, (4.10)."""
        middle = ((first[0] + second[0]) / 2.0, (first[1] + second[1]) / 2.0)
        return cls(name, middle, direction(first, second), math.dist(first, second))

    @classmethod
    def ground(cls) -> "Body":
        """Return the base, whose coordinate system is the global one."""
        return cls("ground", (0.0, 0.0), 0.0, 0.0)

    @property
    def first_end(self) -> Pin:
        """The end at which the body begins, as a place to pin another body to."""
        return self.name, (-self.length_m / 2.0, 0.0)

    @property
    def second_end(self) -> Pin:
        """The end at which the body stops."""
        return self.name, (self.length_m / 2.0, 0.0)

    def local(self, point: Point) -> Point:
        """Return a point of the design position in this body's own coordinates, the inverse of (4.4)."""
        x, y = point[0] - self.origin_m[0], point[1] - self.origin_m[1]
        cosine, sine = math.cos(self.angle_rad), math.sin(self.angle_rad)
        return cosine * x + sine * y, cosine * y - sine * x


@dataclass(frozen=True, slots=True)
class Ground:
    """A body that stays where it is, (4.8)."""

    body: str


@dataclass(frozen=True, slots=True)
class Revolute:
    """Two bodies that share one point and turn about it, (4.7)."""

    first: Pin
    second: Pin


@dataclass(frozen=True, slots=True)
class Rigid:
    """Two bodies that share one point and keep the angle from the first to the second, (4.35)."""

    first: Pin
    second: Pin
    angle_rad: float


@dataclass(frozen=True, slots=True)
class Driving:
    """One body whose angle is given from outside, (4.9)."""

    body: str


Joint = Ground | Revolute | Rigid | Driving
_EQUATIONS = {Ground: 3, Revolute: 2, Rigid: 3, Driving: 1}


class Mechanism:
    """Bodies and joints, assembled into one vector of constraints.

    With the coordinates q, their angles and the drive angle d it is
    C(q, d) = linear q + cosine cos(angles) + sine sin(angles) - constant - drive d.

    Parameters
    ----------
    bodies
        In the order of their coordinates in q.
    joints
        In the order of their equations in C; together as many as there are coordinates, one of them
        `Driving`.

    """

    def __init__(self, bodies: Sequence[Body], joints: Sequence[Joint]) -> None:
        """Fill the matrices; ValueError when the joints do not settle as many coordinates as there are."""
        self.bodies = {body.name: index for index, body in enumerate(bodies)}
        #: Coordinates at the design position, from which the solver starts.
        self.design = np.array([value for body in bodies for value in (*body.origin_m, body.angle_rad)])
        equations = sum(_EQUATIONS[type(joint)] for joint in joints)
        if equations != self.design.size:
            raise ValueError(f"{equations} constraint equations cannot settle {self.design.size} coordinates")
        self.linear = np.zeros((equations, equations))
        self.cosine = np.zeros((equations, len(bodies)))
        self.sine = np.zeros((equations, len(bodies)))
        self.constant = np.zeros(equations)
        self.drive = np.zeros(equations)
        (self.driven,) = (joint.body for joint in joints if isinstance(joint, Driving))
        row = 0
        for joint in joints:
            self._add(joint, row)
            row += _EQUATIONS[type(joint)]

    def angle(self, body: str) -> int:
        """Return the place of a body's angle among the coordinates."""
        return 3 * self.bodies[body] + 2

    def constraints(self, coordinates: Floats, drive_rad: Floats) -> Floats:
        """Return C(q, d), (4.11), all zero where every joint holds; shape of `coordinates` [..., n]."""
        angles = coordinates[..., 2::3]
        turning = np.cos(angles) @ self.cosine.T + np.sin(angles) @ self.sine.T
        fixed = coordinates @ self.linear.T - self.constant
        return np.asarray(fixed + turning - np.asarray(drive_rad)[..., np.newaxis] * self.drive)

    def jacobian(self, coordinates: Floats) -> Floats:
        """Return the derivative of C by the coordinates, (4.12), (4.13), shape [..., n, n]."""
        angles = coordinates[..., np.newaxis, 2::3]
        result = np.broadcast_to(self.linear, (*coordinates.shape, self.design.size)).astype(coordinates.dtype)
        result[..., 2::3] += self.sine * np.cos(angles) - self.cosine * np.sin(angles)
        return result

    def turning(self, coordinates: Floats, velocities: Floats) -> Floats:
        """Return Q_d of (4.20), (4.23), what the bodies' turning adds to (4.19); shape of `coordinates`.

        The drive angle enters linearly and time not at all, so of (4.20) only its first term is left, and of
        that only the squares of the angular velocities.
        """
        angles, squares = coordinates[..., 2::3], velocities[..., 2::3] ** 2
        return np.asarray((np.cos(angles) * squares) @ self.cosine.T + (np.sin(angles) * squares) @ self.sine.T)

    def point(self, coordinates: Floats, pin: Pin) -> Floats:
        """Return where a point of a body is, (4.4), [m], shape [..., 2]."""
        (body, (x, y)), first = pin, 3 * self.bodies[pin[0]]
        cosine, sine = (function(coordinates[..., self.angle(body)]) for function in (np.cos, np.sin))
        turned = np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)
        return np.asarray(coordinates[..., first : first + 2] + turned)

    def _add(self, joint: Joint, row: int) -> None:
        match joint:
            case Ground(body):
                first = 3 * self.bodies[body]
                self.linear[row : row + 3, first : first + 3] = np.eye(3)
                self.constant[row : row + 3] = self.design[first : first + 3]
            case Revolute(first_pin, second_pin):
                self._add_shared_point(first_pin, second_pin, row)
            case Rigid(first_pin, second_pin, angle_rad):
                self._add_shared_point(first_pin, second_pin, row)
                self.linear[row + 2, self.angle(second_pin[0])] = 1.0
                self.linear[row + 2, self.angle(first_pin[0])] = -1.0
                self.constant[row + 2] = angle_rad
            case Driving(body):
                self.linear[row, self.angle(body)] = 1.0
                self.drive[row] = 1.0

    def _add_shared_point(self, first: Pin, second: Pin, row: int) -> None:
        for (body, (x, y)), sign in ((first, 1.0), (second, -1.0)):
            index = self.bodies[body]
            self.linear[[row, row + 1], [3 * index, 3 * index + 1]] = sign
            self.cosine[row : row + 2, index] = sign * x, sign * y
            self.sine[row : row + 2, index] = -sign * y, sign * x


def direction(start: Point, end: Point) -> float:
    """Return the angle from +X of the way from one point to another [rad], in (-pi, pi]."""
    return math.atan2(end[1] - start[1], end[0] - start[0])
