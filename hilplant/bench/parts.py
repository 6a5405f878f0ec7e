"""What the files of parts may say: parameter sets of motors, geometries of linkages."""

from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from hilplant.checked_yaml.checked import Checked, Name, NotNegative, Positive, Real, wrong
from hilplant.mechanics.assembly import Description
from hilplant.mechanics.transmission import LEAST_TRANSMISSION_DEG
from hilplant.models.records import Brush, Motor

Point = Annotated[list[Real], Field(min_length=2, max_length=3)]
Efficiency = Annotated[float, Field(gt=0, le=1)]
BackEfficiency = Annotated[float, Field(ge=0, le=1)]

#: Beyond this coordinate [m] a design point was written in another unit.
FARTHEST_M = 10.0


class WithAssumptions(Checked):
    """A group that names those of its keys whose values nobody measured or published."""

    assumed: Annotated[list[str], Field(default_factory=list)]

    @model_validator(mode="after")
    def _assumed_are_given(self) -> Self:
        for key in self.assumed:
            if key not in self.model_fields_set or key == "assumed":
                raise wrong("assumed", text=f"assumed names '{key}', which is not given beside it")
        return self


def assumed_in(part: Checked, prefix: str = "") -> Iterator[str]:
    """Name every value of a part that is assumed, those of inner groups included."""
    status, assumed = getattr(part, "status", ""), getattr(part, "assumed", [])
    if status == "assumed":
        yield f"{prefix}*"
    yield from (f"{prefix}{key}" for key in assumed)
    for key in type(part).model_fields:
        inner = getattr(part, key)
        if isinstance(inner, Checked):
            yield from assumed_in(inner, f"{prefix}{key}.")


class Sourced(WithAssumptions):
    """A parameter set as a document: what it is, where its numbers come from, how they were obtained.

    `identified` is what identification says of its result: data, cost, seed, date and intervals.
    """

    name: Name
    source: Name
    status: Literal["measured", "identified", "published", "assumed"]
    comment: str = ""
    identified: dict[str, Any] | None = None


class BrushSection(WithAssumptions):
    """The armature circuit seen from one brush, (3.30), (3.31)."""

    resistance_ohm: Positive
    inductance_henry: Positive
    constant_v_s: Positive

    def record(self) -> Brush:
        """Return the parameters as the models take them."""
        return Brush(self.resistance_ohm, self.inductance_henry, self.constant_v_s)


class MotorFile(Sourced):
    """A two-speed permanent-magnet motor with its gear."""

    slow: BrushSection
    fast: BrushSection
    inertia_kg_m2: Positive
    damping_n_m_s: NotNegative
    coulomb_torque_n_m: NotNegative = 0.0
    gear_ratio: Positive
    gear_efficiency: Efficiency = 1.0
    gear_back_efficiency: BackEfficiency = 0.0

    def record(self) -> Motor:
        """Return the parameters as the models take them."""
        slow, fast = self.slow.record(), self.fast.record()
        return Motor(
            slow,
            fast,
            inertia_kg_m2=self.inertia_kg_m2,
            damping_n_m_s=self.damping_n_m_s,
            coulomb_torque_n_m=self.coulomb_torque_n_m,
            gear_ratio=self.gear_ratio,
            gear_efficiency=self.gear_efficiency,
            gear_back_efficiency=self.gear_back_efficiency,
        )


class PointsSection(WithAssumptions):
    """Joints by their letter, [x, y] or [x, y, z]."""

    points_m: dict[str, Point]

    @model_validator(mode="after")
    def _in_metres(self) -> Self:
        for name, point in self.points_m.items():
            if max(map(abs, point)) > FARTHEST_M:
                text = f"{name} is {max(point, key=abs):g} m away, and no part of a wiper beyond {FARTHEST_M:g} m"
                raise wrong("points_m", name, text=f"{text}: points are in metres, not in millimetres")
        return self


class ArmSection(PointsSection):
    """An arm, seen from its own pivot."""

    kind: Literal["straight", "bent"]
    mass_kg: NotNegative | None = None


class BladeSection(PointsSection):
    """A blade, seen from the joint that holds it."""

    mass_kg: NotNegative | None = None


class LinkageFile(Sourced, PointsSection):
    """A linkage with the arms and blades that it carries, at the design position.

    `bodies`, `joints` and the names of three of the bodies describe an assembly; the other kinds know theirs.
    """

    kind: Literal["slave_driven", "master_driven", "centre_driven", "assembly"]
    bodies: dict[str, list[str]] | None = None
    joints: list[dict[str, Any]] | None = None
    crank: Name | None = None
    left_rocker: Name | None = None
    right_rocker: Name | None = None
    least_transmission_deg: Annotated[float, Field(gt=0, lt=90)] = LEAST_TRANSMISSION_DEG
    least_clearance_m: NotNegative | None = None
    masses_kg: dict[str, NotNegative] | None = None
    pivot_damping_n_m_s: NotNegative = 0.0
    left_arm: ArmSection
    right_arm: ArmSection
    left_blade: BladeSection
    right_blade: BladeSection

    @model_validator(mode="after")
    def _described_only_as_assembly(self) -> Self:
        for key in ("bodies", "joints"):
            if self.kind == "assembly" and getattr(self, key) is None:
                raise wrong("kind", text=f"an assembly needs {key}; see docs/bench.md")
        for key in ("bodies", "joints", "crank", "left_rocker", "right_rocker"):
            if self.kind != "assembly" and key in self.model_fields_set:
                raise wrong(key, text=f"{key} is for the kind assembly; {self.kind} knows its own")
        return self

    def description(self) -> Description:
        """Return the assembly that is described."""
        roles = {role: getattr(self, role) or role for role in ("crank", "left_rocker", "right_rocker")}
        return Description(self.points_m, self.bodies or {}, self.joints or [], **roles)
