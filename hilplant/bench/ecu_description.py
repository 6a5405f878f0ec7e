"""What a bench may say about the stand-in relay ECU: its messages, times and thresholds."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from hilplant.bench.description import Messages
from hilplant.checked_yaml.checked import Checked, NotNegative, Positive, wrong

SixPauses = Annotated[tuple[Positive, ...], Field(strict=False, min_length=6, max_length=6)]
Count = Annotated[int, Field(ge=1)]


class ControllerSettings(Checked):
    """Times and thresholds of the controller; `docs/ecu.md` says where each default comes from."""

    pauses_s: SixPauses = (1.0, 2.0, 4.0, 7.0, 12.0, 18.0)
    wash_wipes: Count = 3
    debounce_s: NotNegative = 0.02
    turn_timeout_s: Positive = 10.0
    leave_timeout_s: Positive = 2.0
    bounce_edges: Annotated[int, Field(ge=3)] = 10
    bounce_window_s: Positive = 1.0
    stall_current_a: Positive = 10.0
    stall_s: Positive = 0.5
    brown_out_v: NotNegative = 6.0
    resume_v: NotNegative = 8.0
    resume_s: NotNegative = 0.5
    tries: Count = 3
    retry_pause_s: NotNegative = 2.0
    settle_s: Positive = 0.5
    rests_open: bool = False

    @model_validator(mode="after")
    def _thresholds_in_order(self) -> Self:
        if self.resume_v < self.brown_out_v:
            raise wrong("resume_v", text=f"resume_v must be at least brown_out_v, which is {self.brown_out_v:g}")
        if self.leave_timeout_s > self.turn_timeout_s:
            text = f"leave_timeout_s must be at most turn_timeout_s, which is {self.turn_timeout_s:g}"
            raise wrong("leave_timeout_s", text=text)
        return self


class EcuSettings(ControllerSettings):
    """The stand-in relay ECU: how often it decides, and its messages beside those of the plant's mapping."""

    period_ms: Positive = 5.0
    receive: Messages
    send: Messages
