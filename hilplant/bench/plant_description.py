"""What the plant section of a bench may say."""

from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, Union, cast

from pydantic import Field, WithJsonSchema, create_model, field_validator, model_validator

from hilplant.bench.durations import Milliseconds
from hilplant.bench.electrical_sections import CurrentSensorSection, RelaysSection, SupplySection, WiresSection
from hilplant.bench.heat_section import HeatSection
from hilplant.bench.load_files import PolynomialFile, TorqueFile
from hilplant.bench.motor_network_file import MotorNetworkFile
from hilplant.bench.obstacle_section import ObstaclesSection
from hilplant.bench.parts import LinkageFile, MotorFile, Referred, WithAssumptions
from hilplant.bench.screen_parts import ScreenFile
from hilplant.bench.slow_sections import BacklashSection, WaterSection, WearSection
from hilplant.checked_yaml.checked import Checked, Container, MayBeHole, NotNegative, Real, wrong
from hilplant.models.load import LOADS

Angle = Annotated[float, Field(gt=0, lt=360)]
_PAIR = {"type": "array", "prefixItems": [{"type": "number"}, {"type": "number"}], "minItems": 2, "maxItems": 2}
#: A number, or pairs of arm angle [deg] and number.
Coefficient = Annotated[Any, WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "array", "items": _PAIR}]})]


class OdeMotor(Checked):
    """The physical model, (3.30) to (3.35)."""

    model: Literal["ode"] = Field(description="name of the model")


class NarxMotor(Checked):
    """A network with feedback, section 6.4.3; the physical model stands by."""

    model: Literal["narx"] = Field(description="name of the model")
    file: Annotated[MotorNetworkFile, Referred(trained=True)] = Field(description="file from hilplant train motor")


class NoLoad(Checked):
    """Nothing but the linkage, without weight."""

    model: Literal["none"] = Field(description="name of the model")


class PolynomialLoad(Checked):
    """No-load torque fitted over angle and speed, (6.1)-(6.3): the published one, or that of a trained file."""

    model: Literal["polynomial"] = Field(description="name of the model")
    c1: NotNegative | None = Field(default=None, description="first constant of (6.3)")
    c2: NotNegative | None = Field(default=None, description="second constant of (6.3)")
    file: Annotated[PolynomialFile | None, Referred(trained=True)] = Field(
        default=None, description="file from hilplant train polynomial, instead of c1 and c2"
    )

    @model_validator(mode="after")
    def _one_or_the_other(self) -> Self:
        filed = "file" in self.model_fields_set
        for key in ("c1", "c2"):
            if (getattr(self, key) is None) != filed:
                text = f"{key} is given beside the file that has it" if filed else f"key '{key}' is missing"
                raise wrong(key if filed else "model", text=text)
        return self


class WholeWiper(Checked):
    """A load that is the whole wiper; friction acts at `points` points of each blade."""

    points: Annotated[int, Field(ge=1, le=64)] = Field(
        default=1, description="at how many points of each blade friction acts; 1: at the arm's end"
    )


class ReducedLoad(WholeWiper):
    """The whole wiper, reduced to the crank."""

    model: Literal["reduced"] = Field(description="name of the model")


class NetworkLoad(WholeWiper):
    """A network trained for the whole wiper, and the reduced load where the network was not trained."""

    model: Literal["network"] = Field(description="name of the model")
    file: Annotated[TorqueFile, Referred(trained=True)] = Field(description="file from hilplant train torque")


class PlainLoad(Checked):
    """A load that takes two coefficients, whose meaning is its model's."""

    model: str = Field(description="name of the model")
    c1: Real = Field(default=0.0, description="first coefficient of the model")
    c2: Real = Field(default=0.0, description="second coefficient of the model")


AnyLoad = NoLoad | PolynomialLoad | ReducedLoad | NetworkLoad | PlainLoad
#: One description for each model: its own, or else that of a plain load.
_OWN = {"none": NoLoad, "polynomial": PolynomialLoad, "reduced": ReducedLoad, "network": NetworkLoad}
_LOADS = tuple(
    _OWN.get(name) or create_model(name, __base__=PlainLoad, model=(cast(Any, Literal[name]), ...)) for name in LOADS
)
if TYPE_CHECKING:
    EachLoad = AnyLoad
else:
    EachLoad = Union[_LOADS]  # noqa: UP007


class BladeEntry(WithAssumptions):
    """One blade on its screen: force of its arm, factor on its friction, and what the air does to it.

    Drag and lift are coefficients of (4.51), (4.52), each a number or pairs of arm angle [deg] and number.
    """

    force_n: NotNegative = Field(description="with which the arm presses the blade on the screen")
    wear: NotNegative = Field(default=1.0, description="factor on the blade's friction coefficient")
    area_m2: NotNegative = Field(default=0.0, description="area of the blade in (4.51), (4.52)")
    drag: Coefficient = Field(default=0.0, description="coefficient of (4.51); positive pushes forward")
    lift: Coefficient = Field(default=0.0, description="coefficient of (4.52); positive lifts the blade off")

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


class BladesSection(Container):
    """Both blades on their screen."""

    left: BladeEntry = Field(description="the left blade")
    right: BladeEntry = Field(description="the right blade")


class ParkSwitchSection(WithAssumptions):
    """Contact over the crank angle, and the circuit that it is part of."""

    park_angle_deg: Annotated[float, Field(ge=0, lt=360)] = Field(description="crank angle of the window's middle")
    window_deg: Angle = Field(description="width of the window in which the contact is closed")
    hysteresis_deg: NotNegative = Field(
        default=0.0, description="how much farther the crank turns until the contact opens"
    )
    bounce_ms: Milliseconds = Field(default=0.0, description="for how long the contact bounces after each edge")
    circuit: Literal["digital", "mechanical", "depressed"] = Field(
        default="digital",
        description="digital: the contact reports; mechanical, depressed: it carries the motor's current",
    )
    reverse_angle_deg: Angle | None = Field(
        default=None, description="how far the depressed circuit turns the crank back"
    )

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


class PlantSection(Container):
    """What stands on the bench."""

    motor: Annotated[MotorFile, Referred()] = Field(description="parameter set of a motor")
    motor_model: Annotated[OdeMotor | NarxMotor | None, Field(discriminator="model"), MayBeHole] = Field(
        default=None, description="which model moves the motor; ode when left out"
    )
    linkage: Annotated[LinkageFile, Referred()] = Field(description="geometry with its arms, blades and masses")
    screen: Annotated[ScreenFile | None, Referred()] = Field(default=None, description="windscreen: angle and friction")
    blades: BladesSection | None = Field(default=None, description="both blades; the reduced load needs them")
    load: Annotated[EachLoad, Field(discriminator="model"), MayBeHole] = Field(description="what the crank has to move")
    park_switch: ParkSwitchSection = Field(description="the park contact and its circuit")
    supply: SupplySection | None = Field(default=None, description="resistance of the supply; ideal when left out")
    wires: WiresSection | None = Field(default=None, description="wires to the motor; ideal when left out")
    relays: RelaysSection | None = Field(default=None, description="times of the relays; ideal when left out")
    current_sensor: CurrentSensorSection | None = Field(
        default=None, description="noise and ripple of the measured current; ideal when left out"
    )
    heat: HeatSection | None = Field(default=None, description="how the motor gets warm; it stays cold when left out")
    obstacles: ObstaclesSection | None = Field(
        default=None, description="what stands in the arms' way; nothing when left out"
    )
    backlash: BacklashSection | None = Field(
        default=None, description="play between crank and linkage; none when left out"
    )
    wear: WearSection | None = Field(default=None, description="how it wears with its wipes; not when left out")
    water: WaterSection | None = Field(
        default=None, description="water on the screen and rain sensor; `screen` alone tells wetness when left out"
    )
