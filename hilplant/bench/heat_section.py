"""What a bench says about the heat of its motor."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from hilplant.bench.parts import WithAssumptions
from hilplant.checked_yaml.checked import Positive, wrong
from hilplant.models.slow_records import ROOM_TEMPERATURE_C, Heat

#: Temperatures that a motor can be at [degC].
Temperature = Annotated[float, Field(ge=-60, le=400)]
#: Copper at 20 degC by IEC 60028; hard ferrite's remanence by MMPA 0100-00 [%/K].
COPPER_PERCENT_K, FERRITE_PERCENT_K = 0.39, -0.2


class HeatSection(WithAssumptions):
    """The motor as two bodies that copper and friction warm, and its thermal switch."""

    winding_j_k: Positive = Field(description="heat capacity of the armature with its winding")
    case_j_k: Positive = Field(description="heat capacity of the case with the magnets")
    winding_to_case_w_k: Positive = Field(description="conductance from the winding to the case")
    case_to_ambient_w_k: Positive = Field(description="conductance from the case to the air")
    resistance_percent_k: Annotated[float, Field(ge=-2, le=2)] = Field(
        default=COPPER_PERCENT_K, description="change of the winding's resistance"
    )
    constant_percent_k: Annotated[float, Field(ge=-2, le=2)] = Field(
        default=FERRITE_PERCENT_K, description="change of the motor constant with the magnets' temperature"
    )
    reference_c: Temperature = Field(
        default=ROOM_TEMPERATURE_C, description="temperature at which the motor file holds"
    )
    start_c: Temperature = Field(default=ROOM_TEMPERATURE_C, description="temperature of both bodies at tick 0")
    trip_c: Temperature | None = Field(
        default=None, description="winding temperature at which the thermal switch opens; none: there is none"
    )
    reset_c: Temperature | None = Field(default=None, description="winding temperature at which it closes")

    @model_validator(mode="after")
    def _resets_below_its_trip(self) -> Self:
        if (self.trip_c is None) != (self.reset_c is None):
            raise wrong("trip_c" if self.reset_c is None else "reset_c", text="trip_c and reset_c are given together")
        if self.trip_c is not None and self.reset_c is not None and not self.reset_c < self.trip_c:
            raise wrong("reset_c", text=f"reset_c must be below trip_c, {self.trip_c:g}")
        return self

    def record(self) -> Heat:
        """Return the parameters as the models take them."""
        return Heat(
            altered=1.0,
            winding_j_k=self.winding_j_k,
            case_j_k=self.case_j_k,
            winding_to_case_w_k=self.winding_to_case_w_k,
            case_to_ambient_w_k=self.case_to_ambient_w_k,
            resistance_per_k=0.01 * self.resistance_percent_k,
            constant_per_k=0.01 * self.constant_percent_k,
            reference_c=self.reference_c,
            trip_c=self.trip_c or 0.0,
            reset_c=self.reset_c or 0.0,
            has_switch=0.0 if self.trip_c is None else 1.0,
            start_c=self.start_c,
        )
