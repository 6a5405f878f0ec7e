"""What the file of a windscreen may say: its angle, and the friction of blades on it."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from hilplant.bench.parts import Sourced, WithAssumptions
from hilplant.checked_yaml.checked import NotNegative, Positive, Real, wrong
from hilplant.models.records import Friction

QuarterTurn = Annotated[float, Field(ge=-1.5708, le=1.5708)]


class DrySection(WithAssumptions):
    """Coefficients of (4.49); the fourth is ten times the third when it is left out, as in the thesis."""

    mu_dry_1: NotNegative
    mu_dry_2: NotNegative
    mu_dry_3: NotNegative
    mu_dry_4: NotNegative | None = None

    def values(self) -> tuple[float, ...]:
        """Return all four in order."""
        fourth = 10.0 * self.mu_dry_3 if self.mu_dry_4 is None else self.mu_dry_4
        return self.mu_dry_1, self.mu_dry_2, self.mu_dry_3, fourth


class WetSection(WithAssumptions):
    """Coefficients of (4.50); the second and the fifth are ten times the one before when they are left out."""

    mu_wet_1: NotNegative
    mu_wet_2: NotNegative | None = None
    mu_wet_3: NotNegative
    mu_wet_4: NotNegative
    mu_wet_5: NotNegative | None = None
    mu_wet_6: Real
    mu_wet_7: Real

    def values(self) -> tuple[float, ...]:
        """Return all seven in order."""
        second = 10.0 * self.mu_wet_1 if self.mu_wet_2 is None else self.mu_wet_2
        fifth = 10.0 * self.mu_wet_4 if self.mu_wet_5 is None else self.mu_wet_5
        return self.mu_wet_1, second, self.mu_wet_3, self.mu_wet_4, fifth, self.mu_wet_6, self.mu_wet_7


class TackySection(WithAssumptions):
    """Coefficients of the tacky screen: settled value, rate of the rise, height of the peak, rate of its fall."""

    mu_tacky_1: NotNegative
    mu_tacky_2: Positive
    mu_tacky_3: NotNegative
    mu_tacky_4: NotNegative

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

    angle_rad: QuarterTurn
    velocity_limit_mm_s: Positive
    dry: DrySection
    wet: WetSection
    tacky: TackySection

    def friction(self) -> Friction:
        """Return the coefficients as the models take them."""
        numbers = (*self.dry.values(), *self.wet.values(), *self.tacky.values(), self.velocity_limit_mm_s)
        return Friction._make(numbers)
