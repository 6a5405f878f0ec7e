"""The `faults` section of a scenario: what is inserted, when, and for how long."""

import json
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, ValidationInfo, field_validator, model_validator

from hilplant.checked_yaml.checked import Checked, NotNegative, Positive, keys_of, wrong
from hilplant.failure import Failure
from hilplant.faults.catalogue import fault_named
from hilplant.faults.fault import About
from hilplant.faults.timing import Inserted
from hilplant.signals import INPUTS, OUTPUTS
from hilplant.verdicts.conditions import condition_of
from hilplant.verdicts.known import Known, KnownSignal

#: What `when` may name: the plant's signals, of the tick before.
SIGNALS: Mapping[str, KnownSignal] = {
    signal.name: KnownSignal(
        signal.unit,
        signal.kind != "real",
        {name: float(index) for index, name in enumerate(signal.choices)} | dict(signal.names),
    )
    for signal in (*INPUTS, *OUTPUTS)
}


class FaultEntry(Checked):
    """One fault and its course; times in seconds from the first tick."""

    fault: str = Field(description="name of a fault; `hilplant faults` lists them")
    quantities: Annotated[dict[str, float], Field(default_factory=dict, alias="with", description="its quantities")]
    at: NotNegative = Field(default=0.0, description="from when on it may come [s]")
    lasts: Positive | None = Field(
        default=None, alias="for", description="how long it lasts [s]; to the end if left out"
    )
    when: Annotated[
        dict[str, Any], Field(default_factory=dict, description="it comes when this first holds, on the tick before")
    ]
    probability: Annotated[float, Field(default=1.0, ge=0.0, le=1.0, description="that it comes, each time")]
    seed: Annotated[int, Field(default=0, ge=0, description="where the random numbers of `probability` begin")]
    ramp: NotNegative = Field(default=0.0, description="how long it takes to grow to its full size [s]")
    pause: NotNegative = Field(default=0.0, description="intermittent: away for this long [s], then there for `for`")
    message: str | None = Field(default=None, description="faults of the bus: the message that they are about")
    signal: str | None = Field(default=None, description="faults of the bus: the signal that is written")
    value: float | None = Field(default=None, description="faults of the bus: what the signal says, in its unit")
    direction: Literal["to plant", "from plant"] | None = Field(
        default=None, description="faults of the bus: whose frames, where no message is named"
    )

    @field_validator("when")
    @classmethod
    def _sound(cls, when: dict[str, Any], _: ValidationInfo) -> dict[str, Any]:
        try:
            condition_of(when, Known(1.0, 1.0, SIGNALS, {}))
        except ValueError as error:
            raise wrong(text=str(error)) from None
        return when

    @model_validator(mode="after")
    def _known(self) -> "FaultEntry":
        try:
            fault = fault_named(self.fault)
            fault.complete(self.quantities)
            fault.check_about(self.about)
        except Failure as error:
            raise wrong("fault", text=str(error)) from None
        if self.ramp and fault.on_frames is not None:
            raise wrong("ramp", text="a fault of the bus is there or not; it cannot grow")
        if self.pause and self.lasts is None:
            raise wrong("pause", text="an intermittent fault needs `for`, how long it is there each time")
        return self

    @property
    def about(self) -> About:
        """What a fault of the bus is about."""
        return About(self.message, self.signal, self.value, self.direction)

    def inserted(self, step_s: float, place: str = "") -> Inserted:
        """Return it in ticks of `step_s`; times are rounded to ticks, and none that is not 0 becomes 0."""
        fault = fault_named(self.fault)

        def ticks(seconds: float) -> int:
            return max(1, round(seconds / step_s)) if seconds > 0.0 else 0

        return Inserted(
            fault=fault,
            values=fault.complete(self.quantities),
            at=round(self.at / step_s),
            ticks=None if self.lasts is None else ticks(self.lasts),
            when=condition_of(self.when, Known(step_s, float("inf"), SIGNALS, {})),
            probability=self.probability,
            seed=self.seed,
            ramp=ticks(self.ramp),
            pause=ticks(self.pause),
            place=place,
            about=self.about,
        )


#: The keys of a fault's course and of what it is about; all others are its quantities, where all are named alike.
_COURSE = keys_of(FaultEntry) - {"fault", "with"}


def entry_named(name: str, keys: Mapping[str, Any]) -> FaultEntry:
    """Return a fault of which all keys stand side by side: ``resistance_ohm=0.5, for_=1.0``; `for_` stands for `for`.

    Raises
    ------
    Failure
        Saying what would be right.

    """
    given = {key.rstrip("_"): value for key, value in keys.items()}
    course = {key: value for key, value in given.items() if key in _COURSE}
    quantities = {key: value for key, value in given.items() if key not in _COURSE}
    return _checked({"fault": name, "with": quantities} | course)


def entry_from(text: bytes) -> FaultEntry:
    """Return the fault that a JSON object describes, with a scenario's keys; Failure where it is none."""
    try:
        written = json.loads(text)
    except (ValueError, RecursionError):
        written = None
    if not isinstance(written, dict):
        raise Failure("a fault is one JSON object")
    return _checked(written)


def _checked(written: Any) -> FaultEntry:
    try:
        return FaultEntry.model_validate(written)
    except ValidationError as error:
        told = [(".".join(map(str, each["loc"])), each["msg"]) for each in error.errors()]
        raise Failure(
            "; ".join(text if place in ("", "fault") else f"{place}: {text}" for place, text in told)
        ) from error


#: Entries with the file and line at which each stands.
Written = Sequence[tuple[FaultEntry, str]]


def inserted(written: Written, step_s: float) -> list[Inserted]:
    """Return all entries in ticks."""
    return [entry.inserted(step_s, place) for entry, place in written]


def refuse_faults_of_the_bus(written: Written) -> None:
    """Refuse, with its place, the first fault that needs a bus; for runs that have none.

    Raises
    ------
    Failure
        With the command that has one.

    """
    for entry, place in written:
        if fault_named(entry.fault).on_frames is not None:
            raise Failure(f"{place}: fault '{entry.fault}' acts on frames, and here is no bus; hilplant test has one")
