"""What a bench says about play in the linkage, wear, and water on the screen; whatever is left out is not there."""

import math
from typing import Annotated, Self

from pydantic import Field, model_validator

from hilplant.bench.parts import WithAssumptions
from hilplant.checked_yaml.checked import NotNegative, Positive, wrong
from hilplant.models.mechanical_records import LinkageCondition
from hilplant.models.slow_records import Water, Wear
from hilplant.units import RAD_PER_DEG

SECONDS_PER_HOUR = 3600.0
#: Speed of drops of 2 mm that fall through still air [m/s], Gunn and Kinzer, J. Meteorology 6 (1949).
DROPS_M_S = 6.5


class BacklashSection(WithAssumptions):
    """Play between crank and linkage."""

    angle_deg: Annotated[float, Field(ge=0, le=30)] = Field(description="play, as angle of the crank")

    def record(self) -> LinkageCondition:
        """Return the parameters as the models take them; without play nothing is altered."""
        return LinkageCondition(float(self.angle_deg > 0.0), backlash_rad=self.angle_deg * RAD_PER_DEG)


class WearSection(WithAssumptions):
    """How the wiper wears with its wipes, one for each turn of the crank."""

    blades_percent: NotNegative = Field(default=0.0, description="rise of the blades' friction in 1000 wipes [%]")
    brushes_ohm: NotNegative = Field(default=0.0, description="resistance that 1000 wipes add at each brush")
    cam_deg: NotNegative = Field(default=0.0, description="what 1000 wipes take from each end of the park window")
    start_wipes: NotNegative = Field(default=0.0, description="wipes at tick 0")

    def record(self) -> Wear:
        """Return the parameters as the models take them."""
        return Wear(
            altered=1.0,
            blades=1e-5 * self.blades_percent,
            brushes_ohm=1e-3 * self.brushes_ohm,
            cam_rad=1e-3 * self.cam_deg * RAD_PER_DEG,
            start_wipes=self.start_wipes,
        )


class WaterSection(WithAssumptions):
    """Water on the screen, and the rain sensor."""

    washer_mm_s: NotNegative = Field(description="film that the washer lays on the screen while its pump runs")
    runoff_percent_s: NotNegative = Field(description="part of the film that runs off")
    evaporation_mm_h: NotNegative = Field(description="film that evaporates")
    wiped_percent: Annotated[float, Field(ge=0, lt=100)] = Field(description="part that the pass of a blade takes away")
    dry_mm: NotNegative = Field(description="film up to which the screen is dry")
    tacky_mm: Positive = Field(description="film at which it is tacky")
    wet_mm: Positive = Field(description="film from which on it is wet")
    sensor_mm: Positive = Field(description="film at which the rain sensor shows 63 %")
    start_mm: NotNegative = Field(default=0.0, description="film at tick 0")

    @model_validator(mode="after")
    def _dry_below_tacky_below_wet(self) -> Self:
        if not self.dry_mm < self.tacky_mm:
            raise wrong("tacky_mm", text=f"tacky_mm must be above dry_mm, {self.dry_mm:g}")
        if not self.tacky_mm < self.wet_mm:
            raise wrong("wet_mm", text=f"wet_mm must be above tacky_mm, {self.tacky_mm:g}")
        return self

    def record(self, lean_rad: float) -> Water:
        """Return the parameters as the models take them; `lean_rad` is the screen's from the vertical."""
        return Water(
            altered=1.0,
            catch=math.sin(abs(lean_rad)),
            catch_s_m=math.cos(lean_rad) / DROPS_M_S,
            washer_mm_s=self.washer_mm_s,
            runoff_per_s=0.01 * self.runoff_percent_s,
            evaporation_mm_s=self.evaporation_mm_h / SECONDS_PER_HOUR,
            wiped=-math.log1p(-0.01 * self.wiped_percent),
            dry_mm=self.dry_mm,
            tacky_mm=self.tacky_mm,
            wet_mm=self.wet_mm,
            sensor_mm=self.sensor_mm,
            start_mm=self.start_mm,
        )
