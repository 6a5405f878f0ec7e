"""What the files of parts may say: parameter sets of motors and geometries of linkages."""

from typing import Annotated, Literal

from pydantic import Field

from hilplant.bench.checked import Checked, Name, NotNegative, Positive, Real
from hilplant.models.records import Brush, Motor

Point = Annotated[list[Real], Field(min_length=2, max_length=3)]


class Sourced(Checked):
    """A parameter set as a document: what it is, where its numbers come from, how they were obtained."""

    name: Name
    source: Name
    status: Literal["measured", "identified", "published", "assumed"]
    comment: str = ""


class BrushSection(Checked):
    """The armature circuit seen from one brush, (3.30), (3.31)."""

    resistance_ohm: Positive
    inductance_henry: Positive
    constant_v_s: Positive


class MotorFile(Sourced):
    """A two-speed permanent-magnet motor with its gear."""

    slow: BrushSection
    fast: BrushSection
    inertia_kg_m2: Positive
    damping_n_m_s: NotNegative
    coulomb_torque_n_m: NotNegative = 0.0
    gear_ratio: Positive

    def record(self) -> Motor:
        """Return the parameters as the models take them."""
        slow, fast = (Brush(*brush.model_dump().values()) for brush in (self.slow, self.fast))
        return Motor(
            slow,
            fast,
            inertia_kg_m2=self.inertia_kg_m2,
            damping_n_m_s=self.damping_n_m_s,
            coulomb_torque_n_m=self.coulomb_torque_n_m,
            gear_ratio=self.gear_ratio,
        )


class PointsSection(Checked):
    """Joints by their letter, [x, y] or [x, y, z]."""

    points_m: dict[str, Point]


class ArmSection(PointsSection):
    """An arm, seen from its own pivot."""

    kind: Literal["straight", "bent"]


class LinkageFile(Sourced, PointsSection):
    """A linkage with the arms and blades that it carries, at the design position."""

    kind: Literal["slave_driven"]
    left_arm: ArmSection
    right_arm: ArmSection
    left_blade: PointsSection | None = None
    right_blade: PointsSection | None = None
