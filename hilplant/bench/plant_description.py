"""What the plant section of a bench may say."""

from typing import Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from hilplant.bench.parts import WithAssumptions
from hilplant.checked_yaml.checked import Checked, Name, NotNegative, wrong

Group = dict[str, Any]
Angle = Annotated[float, Field(gt=0, lt=360)]


class PlantSection(Checked):
    """What stands on the bench."""

    motor: Name
    motor_model: Group | None = None
    linkage: Name
    screen: Name | None = None
    blades: Group | None = None
    load: Group
    park_switch: Group


class NoLoad(Checked):
    """Nothing but the linkage, without weight."""

    model: Literal["none"]


class PolynomialLoad(Checked):
    """No-load torque fitted over angle and speed, (6.1)-(6.3): the published one, or that of a trained file."""

    model: Literal["polynomial"]
    c1: NotNegative | None = None
    c2: NotNegative | None = None
    file: Name | None = None

    @model_validator(mode="after")
    def _one_or_the_other(self) -> Self:
        for key in ("c1", "c2"):
            if (getattr(self, key) is None) == (self.file is None):
                text = f"key '{key}' is missing" if self.file is None else f"{key} is given beside the file that has it"
                raise wrong("model" if self.file is None else key, text=text)
        return self


class WholeWiper(Checked):
    """A load that is the whole wiper; friction acts at `points` points of each blade."""

    points: Annotated[int, Field(ge=1, le=64)] = 1


class ReducedLoad(WholeWiper):
    """The whole wiper, reduced to the crank."""

    model: Literal["reduced"]


class NetworkLoad(WholeWiper):
    """A network trained for the whole wiper, and the reduced load where the network was not trained."""

    model: Literal["network"]
    file: Name


AnyLoad = NoLoad | PolynomialLoad | ReducedLoad | NetworkLoad


class LoadChoice(Checked):
    """The load, chosen by the name of its model."""

    load: Annotated[AnyLoad, Field(discriminator="model")]


class BladesSection(Checked):
    """Both blades on their screen."""

    left: Group
    right: Group


class BladeEntry(WithAssumptions):
    """One blade on its screen: force of its arm, factor on its friction, and what the air does to it.

    Drag and lift are coefficients of (4.51), (4.52), each a number or pairs of arm angle [deg] and number.
    """

    force_n: NotNegative
    wear: NotNegative = 1.0
    area_m2: NotNegative = 0.0
    drag: Any = 0.0
    lift: Any = 0.0

    @field_validator("drag", "lift", mode="before")
    @classmethod
    def _number_or_pairs(cls, written: Any) -> Any:
        """Refuse what is neither; what a table must fulfil is checked where it is used."""
        if _is_number(written):
            return float(written)
        if not isinstance(written, list) or not all(map(_is_pair, written)):
            raise wrong(text="drag and lift are each a number, or a list of pairs [arm angle in deg, number]")
        return tuple((float(angle), float(number)) for angle, number in written)

    @model_validator(mode="after")
    def _air_has_an_area_to_act_on(self) -> Self:
        """Refuse a coefficient that would do nothing because the area was left out."""
        for key in ("drag", "lift"):
            if getattr(self, key) != 0.0 and "area_m2" not in self.model_fields_set:
                raise wrong(key, text=f"{key} needs area_m2 beside it, the area of the blade; without it no wind acts")
        return self


def _is_number(written: Any) -> bool:
    return isinstance(written, int | float) and not isinstance(written, bool)


def _is_pair(written: Any) -> bool:
    return isinstance(written, list) and len(written) == 2 and all(map(_is_number, written))


class ParkSwitchSection(WithAssumptions):
    """Contact over the crank angle, and the circuit that it is part of."""

    park_angle_deg: Annotated[float, Field(ge=0, lt=360)]
    window_deg: Angle
    hysteresis_deg: NotNegative = 0.0
    bounce_ms: NotNegative = 0.0
    circuit: Literal["digital", "mechanical", "depressed"] = "digital"
    reverse_angle_deg: Angle | None = None

    @model_validator(mode="after")
    def _window_within_turn(self) -> Self:
        if self.window_deg + 2.0 * self.hysteresis_deg >= 360.0:
            text = "hysteresis_deg must leave a gap: window_deg + 2 hysteresis_deg must be below 360"
            raise wrong("hysteresis_deg", text=text)
        return self

    @model_validator(mode="after")
    def _turns_back_only_when_depressed(self) -> Self:
        if self.circuit == "depressed" and self.reverse_angle_deg is None:
            raise wrong("circuit", text="the depressed circuit needs reverse_angle_deg, how far it turns back to park")
        if self.circuit != "depressed" and self.reverse_angle_deg is not None:
            text = f"reverse_angle_deg is for the depressed circuit, and this one is {self.circuit}"
            raise wrong("reverse_angle_deg", text=text)
        if self.window_deg + (self.reverse_angle_deg or 0.0) >= 360.0:
            text = "reverse_angle_deg must leave a gap: window_deg + reverse_angle_deg must be below 360"
            raise wrong("reverse_angle_deg", text=text)
        return self
