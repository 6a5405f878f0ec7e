"""What a file of readings may say: a motor measured on a bench as in 5.4, its data sheet, or how it is wound."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from hilplant.bench.parts import Sourced
from hilplant.checked_yaml.checked import Checked, Name, NotNegative, Positive, wrong

#: Voltage [V] and current [A] of a motor that is held still.
Blocked = Annotated[list[Positive], Field(min_length=2, max_length=2)]
#: Voltage [V], current [A] and shaft speed [rad/s] of a motor that turns without a load.
NoLoad = Annotated[list[Positive], Field(min_length=3, max_length=3)]


class Given(Checked):
    """Parameters that the readings do not tell, from elsewhere."""

    slow_inductance_henry: Positive | None = None
    fast_inductance_henry: Positive | None = None
    inertia_kg_m2: Positive | None = None
    damping_n_m_s: NotNegative | None = None
    gear_efficiency: Annotated[float, Field(gt=0, le=1)] | None = None


class ArmatureReadings(Checked):
    """The armature as a solid cylinder, (5.21)."""

    mass_kg: Positive
    radius_m: Positive


def _one_of(group: Checked, first: str, second: str) -> None:
    """Refuse two ways to the same parameter: one would be left unused."""
    if getattr(group, first) and getattr(group, second):
        raise wrong(second, text=f"{first} and {second} tell the same; keep one")


class BenchMode(Checked):
    """Readings of one brush.

    The resistance comes from a meter or from blocked points, (5.16); the inductance from the time to 36.8 % of a
    blocked motor's current, (5.19), or from its whole decay: a table of time and current from the step on.
    """

    resistance_ohm: Positive | None = None
    blocked: Annotated[list[Blocked], Field(default_factory=list)]
    no_load: Annotated[list[NoLoad], Field(min_length=1)]
    time_constant_s: Positive | None = None
    decay: Name | None = None

    @model_validator(mode="after")
    def _once(self) -> Self:
        _one_of(self, "resistance_ohm", "blocked")
        _one_of(self, "time_constant_s", "decay")
        return self


class MayLack(Sourced):
    """Readings that need not tell all: `assume: typical` takes typical values for what is missing."""

    assume: Literal["typical"] | None = None


class BenchReadings(MayLack):
    """A motor on a bench. `run_down` is a table of time and shaft speed with open terminals."""

    kind: Literal["bench"]
    gear_ratio: Positive
    reading_error: NotNegative = 0.0
    slow: BenchMode
    fast: BenchMode
    armature: ArmatureReadings | None = None
    run_down: Name | None = None
    given: Given = Given()

    @model_validator(mode="after")
    def _once(self) -> Self:
        _one_of(self, "armature", "run_down")
        return self


class SheetMode(Checked):
    """No-load and stall point of one speed; speed and torque are at the gear's output.

    `resistance_ohm`, by a meter, may stand in the place of the stall current.
    """

    voltage_v: Positive
    no_load_rpm: Positive
    no_load_current_a: Positive | None = None
    stall_current_a: Positive | None = None
    resistance_ohm: Positive | None = None
    stall_torque_n_m: Positive | None = None

    @model_validator(mode="after")
    def _stall(self) -> Self:
        _one_of(self, "stall_current_a", "resistance_ohm")
        if self.stall_torque_n_m is not None and self.stall_current_a is None and self.resistance_ohm is None:
            raise wrong("stall_torque_n_m", text="stall_torque_n_m needs stall_current_a beside it; give both or none")
        return self


class DataSheet(MayLack):
    """A motor as its maker describes it; `tolerance` is the half-width of what each number may be, as a part of it."""

    kind: Literal["data_sheet"]
    gear_ratio: Positive | None = None
    tolerance: NotNegative = 0.0
    slow: SheetMode
    fast: SheetMode
    given: Given = Given()


class GivenBesideWindings(Given):
    """Parameters that magnets and coils do not tell."""

    slow_resistance_ohm: Positive
    fast_resistance_ohm: Positive
    damping_n_m_s: NotNegative
    coulomb_torque_n_m: NotNegative = 0.0


class Windings(MayLack):
    """A motor by its magnets, coils and brushes, section 3.3; `fast_brush_deg` counts from the slow brush."""

    kind: Literal["windings"]
    gear_ratio: Positive
    flux_density_t: Positive
    armature_length_m: Positive
    armature_diameter_m: Positive
    coils: Annotated[int, Field(ge=3, le=200)]
    turns: Annotated[int, Field(ge=1)] = 1
    pitch_slots: Annotated[int, Field(ge=1)]
    fast_brush_deg: Annotated[float, Field(gt=0, lt=180)]
    given: GivenBesideWindings

    @model_validator(mode="after")
    def _reaches_across(self) -> Self:
        if 2 * self.pitch_slots > self.coils:
            raise wrong("pitch_slots", text=f"pitch_slots must be at most half of coils, {self.coils // 2}")
        return self


class AnyReadings(Checked):
    """One of the three, by its `kind`."""

    readings: Annotated[BenchReadings | DataSheet | Windings, Field(discriminator="kind")]


#: What a file of readings holds.
Readings = BenchReadings | DataSheet | Windings
