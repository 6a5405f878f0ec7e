"""What the files of parts may say: parameter sets of motors, geometries of linkages."""

from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, GetCoreSchemaHandler, GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from hilplant.checked_yaml.checked import Checked, Name, NotNegative, Positive, Real, wrong, wrong_value
from hilplant.mechanics.assembly import Description
from hilplant.mechanics.transmission import LEAST_TRANSMISSION_DEG
from hilplant.models.records import Brush, Motor

Point = Annotated[list[Real], Field(min_length=2, max_length=3)]
Efficiency = Annotated[float, Field(gt=0, le=1)]
BackEfficiency = Annotated[float, Field(ge=0, le=1)]

#: Beyond this coordinate [m] a design point was written in another unit.
FARTHEST_M = 10.0


#: Keys of a linkage that only an assembly has.
_OF_ASSEMBLIES = ("bodies", "joints", "crank", "left_rocker", "right_rocker")


class Referred:
    """Marks a part that stands in a file of its own: its name is written, or the part itself.

    What a command has trained is always a file for the schema.
    """

    def __init__(self, *, trained: bool = False) -> None:
        self._trained = trained

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Say what is wrong with a name that no file stands for."""
        return core_schema.no_info_before_validator_function(_a_part, handler(source))

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Return what the schema says."""
        part = handler(core)
        name = {"type": "string", "minLength": 1, "description": "name of the file"}
        return name if self._trained else {"anyOf": [name, *part.get("anyOf", [part])]}


def _a_part(written: Any) -> Any:
    if isinstance(written, str):
        raise wrong_value("must not be empty, not ''" if not written else f"must be a group of keys, not '{written}'")
    return written


class WithAssumptions(Checked):
    """A group that names those of its keys whose values nobody measured or published."""

    assumed: list[str] = Field(default=[], description="keys beside this one whose values nobody measured or published")

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

    name: Name = Field(description="what the part is called in messages")
    source: Name = Field(description="where its numbers come from")
    status: Literal["measured", "identified", "published", "assumed"] = Field(description="how they were obtained")
    comment: str = Field(default="", description="what else there is to say")
    identified: dict[str, Any] | None = Field(
        default=None, description="what identification says: data, cost, seed, intervals"
    )


class BrushSection(WithAssumptions):
    """The armature circuit seen from one brush, (3.30), (3.31)."""

    resistance_ohm: Positive = Field(description="armature resistance")
    inductance_henry: Positive = Field(description="armature inductance")
    constant_v_s: Positive = Field(description="motor constant: back-EMF by speed [V s/rad], torque by current [N m/A]")

    def record(self) -> Brush:
        """Return the parameters as the models take them."""
        return Brush(**{name: getattr(self, name) for name in Brush._fields})


class MotorFile(Sourced):
    """A two-speed permanent-magnet motor with its gear."""

    model_config = ConfigDict(title="hilplant motor")

    slow: BrushSection = Field(description="the slow brush, terminal 53")
    fast: BrushSection = Field(description="the fast brush, terminal 53b")
    inertia_kg_m2: Positive = Field(description="inertia of armature and shaft")
    damping_n_m_s: NotNegative = Field(description="viscous friction at the motor shaft [N m s/rad]")
    coulomb_torque_n_m: NotNegative = Field(default=0.0, description="dry friction at the motor shaft")
    gear_ratio: Positive = Field(description="turns of the motor shaft for one of the crank")
    gear_efficiency: Efficiency = Field(default=1.0, description="of the worm while the motor drives")
    gear_back_efficiency: BackEfficiency = Field(
        default=0.0,
        description="part of the load's torque that reaches the motor while the load drives; 0: self-locking",
    )

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

    points_m: dict[str, Point] = Field(description="points by their letter, [x, y] or [x, y, z] in metres")

    @model_validator(mode="after")
    def _in_metres(self) -> Self:
        for name, point in self.points_m.items():
            if max(map(abs, point)) > FARTHEST_M:
                text = f"{name} is {max(point, key=abs):g} m away, and no part of a wiper beyond {FARTHEST_M:g} m"
                raise wrong("points_m", name, text=f"{text}: points are in metres, not in millimetres")
        return self


class ArmSection(PointsSection):
    """An arm, seen from its own pivot."""

    kind: Literal["straight", "bent"] = Field(description="shape of the arm")
    mass_kg: NotNegative | None = Field(default=None, description="mass of the arm")


class BladeSection(PointsSection):
    """A blade, seen from the joint that holds it."""

    mass_kg: NotNegative | None = Field(default=None, description="mass of the blade")


class JointEntry(Checked):
    """A joint of an assembly: a point that two or more bodies share, or a body that stays where it is."""

    revolute: Name | None = Field(default=None, description="point about which the bodies turn")
    rigid: Name | None = Field(default=None, description="point at which the bodies are one")
    ground: Name | None = Field(default=None, description="body that stays where it is")
    bodies: list[str] | None = Field(default=None, description="bodies that share the point; ground is the base")

    def written(self) -> dict[str, Any]:
        """Return the keys that are given."""
        return self.model_dump(exclude_unset=True)


class LinkageFile(Sourced, PointsSection):
    """A linkage with the arms and blades that it carries, at the design position.

    `bodies`, `joints` and the names of three of the bodies describe an assembly; the other kinds know theirs.
    """

    model_config = ConfigDict(
        title="hilplant linkage",
        json_schema_extra={
            "if": {"properties": {"kind": {"const": "assembly"}}},
            "then": {"required": ["bodies", "joints"]},
            "else": {"properties": dict.fromkeys(_OF_ASSEMBLIES, False)},
        },
    )

    kind: Literal["slave_driven", "master_driven", "centre_driven", "assembly"] = Field(description="which linkage")
    bodies: dict[str, list[str]] | None = Field(default=None, description="assembly: names of the points on each body")
    joints: list[JointEntry] | None = Field(default=None, description="assembly: what joins the bodies")
    crank: Name | None = Field(default=None, description="assembly: name of the body that the motor turns")
    left_rocker: Name | None = Field(default=None, description="assembly: name of the body that carries the left arm")
    right_rocker: Name | None = Field(default=None, description="assembly: name of the body that carries the right arm")
    least_transmission_deg: Annotated[float, Field(gt=0, lt=90)] = Field(
        default=LEAST_TRANSMISSION_DEG,
        description="how near to a dead point it may come, as transmission angle off the line",
    )
    least_clearance_m: NotNegative | None = Field(
        default=None, description="how near the blades may come to each other"
    )
    masses_kg: dict[str, NotNegative] | None = Field(
        default=None, description="mass of every moving body, a slender rod each"
    )
    pivot_damping_n_m_s: NotNegative = Field(
        default=0.0, description="viscous damping of crank and rockers in their pivots [N m s/rad]"
    )
    left_arm: ArmSection = Field(description="the left arm from its pivot outwards")
    right_arm: ArmSection = Field(description="the right arm from its pivot outwards")
    left_blade: BladeSection = Field(description="the left blade from the joint O that holds it")
    right_blade: BladeSection = Field(description="the right blade from the joint O that holds it")

    @model_validator(mode="after")
    def _described_only_as_assembly(self) -> Self:
        for key in ("bodies", "joints"):
            if self.kind == "assembly" and getattr(self, key) is None:
                raise wrong("kind", text=f"an assembly needs {key}; see docs/bench.md")
        for key in _OF_ASSEMBLIES:
            if self.kind != "assembly" and key in self.model_fields_set:
                raise wrong(key, text=f"{key} is for the kind assembly; {self.kind} knows its own")
        return self

    def description(self) -> Description:
        """Return the assembly that is described."""
        roles = {role: getattr(self, role) or role for role in ("crank", "left_rocker", "right_rocker")}
        joints = [joint.written() for joint in self.joints or []]
        return Description(self.points_m, self.bodies or {}, joints, **roles)
