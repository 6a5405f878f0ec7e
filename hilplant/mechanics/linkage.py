"""A linkage of any kind as bodies and joints."""

from collections.abc import Mapping
from dataclasses import dataclass

from hilplant.mechanics.planar import Body, Joint, Mechanism, Point

#: How well the angles must come back after one turn of the crank.
CLOSURE_RAD = 1e-9


@dataclass(frozen=True, slots=True)
class Linkage:
    """What stands between the crank and the two rockers, at the design position.

    Build it with `slave_driven`, `master_driven`, `centre_driven` or `assembly`, each in the file of its name:
    they refuse what cannot make its turn. How near it comes to that is said by
    :func:`hilplant.mechanics.transmission.check_transmission`.

    Attributes
    ----------
    kind
        Name of the maker.
    points
        Design points by name [m], laid into the plane.
    bodies, joints
        For the mechanism; the ground comes first, the drive of the crank is among the joints.
    body_points
        Names of the design points that lie on each body, by the body's name; the first two give its angle.
    left_pivot, right_pivot
        Where the rockers turn about the ground, and the arms with them [m].
    crank, left_rocker, right_rocker
        Names of these bodies.

    """

    kind: str
    points: Mapping[str, Point]
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    body_points: Mapping[str, tuple[str, ...]]
    left_pivot: Point
    right_pivot: Point
    crank: str = "crank"
    left_rocker: str = "left_rocker"
    right_rocker: str = "right_rocker"

    @property
    def design_crank_angle_rad(self) -> float:
        """The crank's angle from +X at the design position, theta_0 of (4.9)."""
        return self.body(self.crank).angle_rad

    def body(self, name: str) -> Body:
        """Return a body as it stands at the design position."""
        return next(body for body in self.bodies if body.name == name)

    def mechanism(self) -> Mechanism:
        """Return the bodies joined together, driven by the crank."""
        return Mechanism(self.bodies, self.joints)
