"""What a bench file may say: one model for each of its sections, which are checked one by one.

Sections are separate so that a mistake in one does not hide the mistakes in another. Cross-checks against the
database, the step or other files are in :mod:`hilplant.bench.mapping` and :mod:`hilplant.bench.assembly`. The plant's
sections are in :mod:`hilplant.bench.plant_description`, the ECU's in :mod:`hilplant.bench.ecu_description`.
"""

from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from hilplant.checked_yaml.checked import Checked, Name, NotNegative, Real, wrong
from hilplant.units import TURN_RAD

Group = dict[str, Any]
OptionalGroup = Annotated[Group, Field(default_factory=dict)]
Messages = Annotated[dict[str, Group], Field(default_factory=dict)]
Pauses = Annotated[tuple[Annotated[int, Field(ge=1)], Annotated[int, Field(ge=1)]], Field(strict=False)]
Whole = Annotated[int, Field(ge=0)]

#: The longest step [s] at which the plant keeps to 0.5 % of the range from any start; beyond it a start may fail.
LONGEST_STEP_S = 0.02


class BenchFile(Checked):
    """The outermost keys."""

    name: Name
    extends: Name | None = None
    step_s: Annotated[float, Field(gt=0, le=LONGEST_STEP_S)] = 0.001
    plant: Group
    bus: Group
    initial: OptionalGroup
    inputs: OptionalGroup
    loop: OptionalGroup
    ecu: OptionalGroup


class InitialSection(Checked):
    """The state at tick 0."""

    crank_angle_rad: Annotated[float, Field(ge=0, lt=TURN_RAD)] = 0.0
    motor_speed_rad_s: Annotated[float, Field(ge=-2000, le=2000)] = 0.0
    current_a: Annotated[float, Field(ge=-500, le=500)] = 0.0


class BusSection(Checked):
    """Outermost keys of the bus."""

    interface: Group
    database: Name
    receive: Messages
    send: Messages
    safe: OptionalGroup


class InterfaceSection(Checked):
    """Arguments of the CAN interface, passed on as they are; only its name is known here."""

    model_config = ConfigDict(extra="allow")

    interface: Name


class SignalEntry(Checked):
    """How one signal of the database relates to one of the plant.

    The plant's value is the database's physical value times `scale` plus `offset`, in both directions.
    """

    signal: Name
    scale: Real = 1.0
    offset: Real = 0.0
    choices: dict[str, str] | None = None
    invert: bool = False

    @model_validator(mode="after")
    def _scale_not_zero(self) -> Self:
        if self.scale == 0.0:
            raise wrong("scale", text="scale must not be 0")
        return self


class ReceiveEntry(Checked):
    """A message that the plant takes in; without `timeout_ms` it may stay away for ten cycle times."""

    signals: Annotated[Group, Field(min_length=1)]
    timeout_ms: NotNegative | None = None
    protection: Group | None = None


class SendEntry(Checked):
    """A message that the plant sends; by default at the database's cycle time; 0: on change only."""

    signals: Annotated[Group, Field(min_length=1)]
    period_ms: NotNegative | None = None
    offset_ms: NotNegative = 0.0
    on_change: Annotated[list[str], Field(default_factory=list)]
    protection: Group | None = None


class LoopSettings(Checked):
    """How the loop runs, and how it treats its interface."""

    on_overrun: Literal["count", "degrade", "stop"] = "count"
    priority: Annotated[int, Field(ge=1, le=99)] = 80
    cpu: Whole | None = None
    frames_per_tick: Annotated[int, Field(ge=1)] = 100
    queue_frames: Annotated[int, Field(ge=1)] = 64
    reopen_ms: Pauses = (100, 2000)

    @model_validator(mode="after")
    def _reopen_grows(self) -> Self:
        if self.reopen_ms[0] > self.reopen_ms[1]:
            raise wrong("reopen_ms", text="reopen_ms must be [first pause, longest pause], rising")
        return self
