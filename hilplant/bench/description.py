"""What a bench says, all of it: the description from which a bench is built, with the files that it names inside.

Cross-checks against the database, the step or the mechanics are made while the bench is built. The plant's sections
are in :mod:`hilplant.bench.plant_description`, the bus's in :mod:`hilplant.bench.bus_description`, the ECU's in
:mod:`hilplant.bench.ecu_description`.
"""

from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from hilplant.bench.bus_description import BusSection
from hilplant.bench.ecu_description import EcuSettings
from hilplant.bench.plant_description import PlantSection
from hilplant.bench.signal_names import InputValues
from hilplant.checked_yaml.checked import Checked, Container, MayBeHole, Name, wrong
from hilplant.units import TURN_RAD

Pauses = Annotated[tuple[Annotated[int, Field(ge=1)], Annotated[int, Field(ge=1)]], Field(strict=False)]
Whole = Annotated[int, Field(ge=0)]
Pace = Annotated[float, Field(ge=0.001, le=1.0)]

#: The longest step [s] at which the plant keeps to 0.5 % of the range from any start; beyond it a start may fail.
LONGEST_STEP_S = 0.02


class InitialSection(Checked):
    """The state at tick 0."""

    crank_angle_rad: Annotated[float, Field(ge=0, lt=TURN_RAD)] = Field(
        default=0.0, description="crank angle from park"
    )
    motor_speed_rad_s: Annotated[float, Field(ge=-2000, le=2000)] = Field(
        default=0.0, description="speed of the motor shaft"
    )
    current_a: Annotated[float, Field(ge=-500, le=500)] = Field(default=0.0, description="armature current")


class LoopSettings(Checked):
    """How the loop runs, and how it treats its interface."""

    on_overrun: Literal["count", "degrade", "stop"] = Field(
        default="count",
        description="what a late tick does: it is counted, or the mode becomes degraded, or the run stops",
    )
    lost_time: Annotated[float, Field(gt=0.0, le=1.0)] = Field(
        default=0.2, description="share of a second that may be lost before the loop counts as behind: exit code 1"
    )
    pace: Pace = Field(
        default=1.0, description="seconds of the plant in a second of the clock; below 1 where a machine is slow"
    )
    priority: Annotated[int, Field(ge=1, le=99)] = Field(
        default=80, description="SCHED_FIFO priority, where it is permitted"
    )
    cpu: Whole | None = Field(default=None, description="processor that the loop is pinned to")
    frames_per_tick: Annotated[int, Field(ge=1)] = Field(
        default=100, description="most frames taken in during one tick"
    )
    queue_frames: Annotated[int, Field(ge=1)] = Field(
        default=64, description="most frames waiting for a full interface"
    )
    reopen_ms: Pauses = Field(
        default=(100, 2000), description="first and longest pause before a lost interface is tried again"
    )

    @model_validator(mode="after")
    def _reopen_grows(self) -> Self:
        if self.reopen_ms[0] > self.reopen_ms[1]:
            raise wrong("reopen_ms", text="reopen_ms must be [first pause, longest pause], rising")
        return self


class BenchDescription(Container):
    """One bench: the plant, its bus, the mapping between them, rates and timeouts."""

    model_config = ConfigDict(title="hilplant bench")

    name: Annotated[Name, MayBeHole] = Field(description="what the bench is called in messages and recordings")
    extends: Annotated[Name | None, MayBeHole] = Field(
        default=None, description="bench from which everything is taken that is not given here"
    )
    step_s: Annotated[float, Field(gt=0, le=LONGEST_STEP_S), MayBeHole] = Field(
        default=0.001, description="step of the plant and period of the loop, whole nanoseconds"
    )
    plant: PlantSection = Field(description="what stands on the bench")
    initial: InitialSection = Field(default=InitialSection(), description="state at tick 0")
    inputs: InputValues = Field(
        default={}, description="inputs of the plant until a frame or a scenario says something else"
    )
    bus: BusSection = Field(description="interface, database and mapping")
    loop: LoopSettings = Field(default=LoopSettings(), description="the real-time loop")
    ecu: EcuSettings = Field(default=EcuSettings(), description="the stand-in relay ECU")
