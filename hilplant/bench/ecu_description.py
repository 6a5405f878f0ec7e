"""What a bench may say about the stand-in relay ECU: its messages, times and thresholds."""

from typing import Annotated, ClassVar, Self

from pydantic import Field, model_validator

from hilplant.bench.bus_description import EcuStatusMessageEntry, StalkMessageEntry
from hilplant.checked_yaml.checked import Checked, NotNegative, Positive, wrong

SixPauses = Annotated[tuple[Positive, ...], Field(strict=False, min_length=6, max_length=6)]
EightLevels = Annotated[
    tuple[Annotated[float, Field(gt=0, le=1)], ...], Field(strict=False, min_length=8, max_length=8)
]
Count = Annotated[int, Field(ge=1)]


class ControllerSettings(Checked):
    """Times and thresholds of the controller; `docs/ecu.md` says where each default comes from."""

    pauses_s: SixPauses = Field(
        default=(1.0, 2.0, 4.0, 7.0, 12.0, 18.0), description="pauses of the intermittent stage"
    )
    wash_wipes: Count = Field(default=3, description="wipes after the wash button is released")
    debounce_s: NotNegative = Field(default=0.02, description="shortest opening of the park contact that is no bounce")
    turn_timeout_s: Positive = Field(default=10.0, description="longest drive without coming to park")
    leave_timeout_s: Positive = Field(default=2.0, description="longest drive with the park contact closed")
    bounce_edges: Annotated[int, Field(ge=3)] = Field(
        default=10, description="changes of the park contact within the window that are a fault"
    )
    bounce_window_s: Positive = Field(
        default=1.0, description="window in which changes of the park contact are counted"
    )
    stall_current_a: Positive = Field(default=10.0, description="current from which the motor counts as stalled")
    stall_s: Positive = Field(default=0.5, description="how long that current must flow")
    warm_stall_current_a: Positive = Field(
        default=5.5, description="current from which a motor counts as stalled that draws it without a break"
    )
    warm_stall_s: Positive = Field(default=4.0, description="how long that current must flow without a break")
    brown_out_v: NotNegative = Field(default=6.0, description="supply voltage below which the relays go off")
    resume_v: NotNegative = Field(default=8.0, description="supply voltage from which it goes on")
    resume_s: NotNegative = Field(default=0.5, description="how long the supply must stay up before")
    tries: Count = Field(default=3, description="drives that may fail before the ECU is locked out")
    retry_pause_s: NotNegative = Field(default=2.0, description="pause before another try")
    settle_s: Positive = Field(
        default=0.5, description="rest in park after which faults are forgotten; also the shortest turn that counts"
    )
    rests_open: bool = Field(default=False, description="whether the parked wiper lies where the park contact is open")

    rain_levels: EightLevels = Field(
        default=(0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8),
        description="signals of the rain sensor from which on automatic takes the six pauses, slow and fast",
    )
    rain_hold_s: NotNegative = Field(default=5.0, description="how long less rain is seen before a stage less is taken")

    @model_validator(mode="after")
    def _thresholds_in_order(self) -> Self:
        if list(self.rain_levels) != sorted(set(self.rain_levels)):
            raise wrong("rain_levels", text="rain_levels must rise")
        if self.resume_v < self.brown_out_v:
            raise wrong("resume_v", text=f"resume_v must be at least brown_out_v, which is {self.brown_out_v:g}")
        if self.leave_timeout_s > self.turn_timeout_s:
            text = f"leave_timeout_s must be at most turn_timeout_s, which is {self.turn_timeout_s:g}"
            raise wrong("leave_timeout_s", text=text)
        return self


class EcuSettings(ControllerSettings):
    """The stand-in relay ECU: how often it decides, and its messages beside those of the plant's mapping."""

    holes_inside: ClassVar[bool] = True
    survives: ClassVar[bool] = True

    period_ms: Positive = Field(default=5.0, description="how often the ECU decides")
    receive: dict[str, StalkMessageEntry] = Field(default={}, description="messages of the stalk")
    send: dict[str, EcuStatusMessageEntry] = Field(default={}, description="messages in which the ECU tells of itself")
