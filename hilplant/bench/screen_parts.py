"""What the file of a windscreen may say: its angle, and the friction of blades on it."""

import math
from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from hilplant.bench.parts import Sourced, WithAssumptions
from hilplant.checked_yaml.checked import NotNegative, Positive, Real, wrong
from hilplant.models.records import Friction

QuarterTurn = Annotated[float, Field(ge=-1.5708, le=1.5708)]


class DrySection(WithAssumptions):
    """Coefficients of (4.49); the fourth is ten times the third when it is left out, as in the thesis."""

    mu_dry_1: NotNegative = Field(description="first coefficient of (4.49)")
    mu_dry_2: NotNegative = Field(description="second coefficient of (4.49)")
    mu_dry_3: NotNegative = Field(description="third coefficient of (4.49)")
    mu_dry_4: NotNegative | None = Field(
        default=None, description="fourth coefficient of (4.49); ten times the third when left out"
    )

    def values(self) -> tuple[float, ...]:
        """Return all four in order."""
        fourth = 10.0 * self.mu_dry_3 if self.mu_dry_4 is None else self.mu_dry_4
        return self.mu_dry_1, self.mu_dry_2, self.mu_dry_3, fourth


class WetSection(WithAssumptions):
    """Coefficients of (4.50); the second and the fifth are ten times the one before when they are left out."""

    mu_wet_1: NotNegative = Field(description="first coefficient of (4.50)")
    mu_wet_2: NotNegative | None = Field(
        default=None, description="second coefficient of (4.50); ten times the first when left out"
    )
    mu_wet_3: NotNegative = Field(description="third coefficient of (4.50)")
    mu_wet_4: NotNegative = Field(description="fourth coefficient of (4.50)")
    mu_wet_5: NotNegative | None = Field(
        default=None, description="fifth coefficient of (4.50); ten times the fourth when left out"
    )
    mu_wet_6: Real = Field(description="sixth coefficient of (4.50)")
    mu_wet_7: Real = Field(description="seventh coefficient of (4.50)")

    def values(self) -> tuple[float, ...]:
        """Return all seven in order."""
        second = 10.0 * self.mu_wet_1 if self.mu_wet_2 is None else self.mu_wet_2
        fifth = 10.0 * self.mu_wet_4 if self.mu_wet_5 is None else self.mu_wet_5
        return self.mu_wet_1, second, self.mu_wet_3, self.mu_wet_4, fifth, self.mu_wet_6, self.mu_wet_7


class TackySection(WithAssumptions):
    """Coefficients of the tacky screen: settled value, rate of the rise, height of the peak, rate of its fall."""

    mu_tacky_1: NotNegative = Field(description="settled value")
    mu_tacky_2: Positive = Field(description="rate of the rise")
    mu_tacky_3: NotNegative = Field(description="height of the peak")
    mu_tacky_4: NotNegative = Field(description="rate of its fall")

    @model_validator(mode="after")
    def _rises_before_it_falls(self) -> Self:
        if self.mu_tacky_4 > self.mu_tacky_2:
            text = f"mu_tacky_4, the rate of the fall, must not be above that of the rise, {self.mu_tacky_2}"
            raise wrong("mu_tacky_4", text=text)
        return self

    def values(self) -> tuple[float, ...]:
        """Return all four in order."""
        return self.mu_tacky_1, self.mu_tacky_2, self.mu_tacky_3, self.mu_tacky_4


class ScreenFile(Sourced):
    """A windscreen: its angle, and the friction of a blade on it, for velocities in mm/s."""

    model_config = ConfigDict(title="hilplant screen")

    angle_rad: QuarterTurn = Field(
        description="how far the screen leans, a turn about the x axis: gamma of (4.47) from the vertical"
    )
    angle_from: Literal["vertical", "horizontal"] = Field(
        default="vertical", description="from which axis angle_rad is; a car's rake is often told from the horizontal"
    )
    velocity_limit_mm_s: Positive = Field(description="velocity beyond which a coefficient keeps its value")
    dry: DrySection = Field(description="friction of the dry screen")
    wet: WetSection = Field(description="friction of the wet screen")
    tacky: TackySection = Field(description="friction of the screen with little water")

    @property
    def from_vertical_rad(self) -> float:
        """The angle from the vertical, gamma of (4.47) [rad]; 0 is an upright screen."""
        if self.angle_from == "vertical":
            return self.angle_rad
        return math.copysign(math.pi / 2.0 - abs(self.angle_rad), self.angle_rad)

    def friction(self) -> Friction:
        """Return the coefficients as the models take them."""
        numbers = (*self.dry.values(), *self.wet.values(), *self.tacky.values(), self.velocity_limit_mm_s)
        return Friction._make(numbers)
