"""What the bus section of a bench may say, and the messages of the ECU's section."""

from typing import Annotated, Any, ClassVar, Self, TypeVar

from pydantic import BeforeValidator, ConfigDict, Field, GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from hilplant.bench.durations import Milliseconds
from hilplant.bench.signal_names import EcuStatusName, InputName, InputValues, PublishedName, StalkName
from hilplant.checked_yaml.checked import (
    Checked,
    Container,
    MayBeHole,
    Name,
    Real,
    shown_value,
    wrong,
    wrong_value,
)

#: Profiles of AUTOSAR E2E that are known, and the ways in which a data id enters a checksum.
E2E_PROFILES = (1, 2, 4, 5, 6, 7, 11)
DATA_ID_MODES = ("both", "alternating", "low", "nibble")


class InterfaceSection(Checked):
    """Arguments of the CAN interface, passed on as they are; only its name is known here."""

    model_config = ConfigDict(
        extra="allow", json_schema_extra={"examples": [{"interface": "socketcan", "channel": "vcan0"}]}
    )

    interface: Name = Field(description="name of an interface of python-can, such as socketcan or virtual")


def _as_label(written: Any) -> Any:
    """Return a flag's value as its label, also where it is written as true, false, 0 or 1."""
    return str(written).lower() if isinstance(written, bool | int) else written


class _TextTrueOrNumber:
    """Lets the schema offer what a label may be written as."""

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {"type": ["string", "boolean", "integer"]}


PlantLabel = Annotated[str, BeforeValidator(_as_label), _TextTrueOrNumber()]


class SignalEntry(Checked):
    """How one signal of the database relates to one of the plant.

    The plant's value is the database's physical value times `scale` plus `offset`, in both directions.
    """

    signal: Name = Field(description="signal of the plant")
    scale: Real = Field(default=1.0, description="factor from the database's value to the plant's; not 0")
    offset: Real = Field(default=0.0, description="what is added after the factor, in the plant's unit")
    choices: dict[str, PlantLabel] | None = Field(
        default=None, description="from labels of the database, or raw numbers, to labels of the plant"
    )
    invert: bool = Field(default=False, description="whether 0 and 1 of a flag change places")

    @model_validator(mode="after")
    def _scale_not_zero(self) -> Self:
        if self.scale == 0.0:
            raise wrong("scale", text="scale must not be 0")
        return self


class InputEntry(SignalEntry):
    """From a signal of the database to an input of the plant."""

    signal: InputName = Field(description="input of the plant")


class PublishedEntry(SignalEntry):
    """From an output or status of the plant to a signal of the database."""

    signal: PublishedName = Field(description="output or status of the plant")


class StalkEntry(SignalEntry):
    """From a signal of the database to one of the stalk."""

    signal: StalkName = Field(description="signal of the stalk")


class EcuStatusEntry(SignalEntry):
    """From a signal of the ECU's status to one of the database."""

    signal: EcuStatusName = Field(description="signal of the ECU's status")


def _listed(written: Any) -> Any:
    """Return what one signal of the database becomes as a list: of one where a name or one group is written."""
    entries = written if isinstance(written, list) else [written]
    if not all(isinstance(entry, str | dict) for entry in entries):
        raise wrong_value(f"must be a group of keys, not {shown_value(written)}")
    return [{"signal": entry} if isinstance(entry, str) else entry for entry in entries]


class _NameGroupOrList:
    """Lets the schema offer a name alone, a group, or a list of these."""

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        group = handler(core)["items"]
        name = handler.resolve_ref_schema(group)["properties"]["signal"]
        return {"anyOf": [name, group, {"type": "array", "items": {"anyOf": [name, group]}, "minItems": 1}]}


Entry = TypeVar("Entry", bound=SignalEntry)
Entries = Annotated[tuple[Entry, ...], Field(strict=False, min_length=1), BeforeValidator(_listed), _NameGroupOrList()]
Inputs = Annotated[dict[str, Entries[InputEntry]], Field(min_length=1)]
Published = Annotated[dict[str, Entries[PublishedEntry]], Field(min_length=1)]
Stalk = Annotated[dict[str, Entries[StalkEntry]], Field(min_length=1)]
EcuStatus = Annotated[dict[str, Entries[EcuStatusEntry]], Field(min_length=1)]


def _listed_values(written: Any) -> Any:
    """Return the values of a term as a list of texts: raw numbers and labels."""
    if not isinstance(written, dict):
        return written
    return {
        name: [
            str(value) if type(value) is int else value for value in (values if isinstance(values, list) else [values])
        ]
        for name, values in written.items()
    }


_LABELS = {"type": ["string", "integer"]}


class _NameOrValues:
    """Lets the schema offer a signal's name alone, or with one value or several."""

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        values = {"anyOf": [_LABELS, {"type": "array", "items": _LABELS, "minItems": 1}]}
        group = {"type": "object", "additionalProperties": values, "minProperties": 1, "maxProperties": 1}
        return {"anyOf": [{"type": "string"}, group]}


Values = Annotated[list[str], Field(min_length=1)]
Term = Annotated[
    str | Annotated[dict[str, Values], Field(min_length=1, max_length=1)],
    BeforeValidator(_listed_values),
    _NameOrValues(),
]


class ConditionEntry(Checked):
    """A flag that several signals of the message decide.

    A term is a signal's name, true while its raw value is not 0, or `Signal: values`, true while it has one of these
    labels or raw numbers.
    """

    any: list[Term] = Field(default=[], description="on while one of these is true")
    all: list[Term] = Field(default=[], description="on only while all of these are true")

    @model_validator(mode="after")
    def _something(self) -> Self:
        if self.any == self.all == []:
            raise wrong(text="a condition needs any or all: a list of signals")
        return self


_CONDITIONS = "flag of the plant: the signals of the message that decide it"
_SIGNALS = "signal of the database: what it is to the plant"


_FD = "whether its frames are FD; as in the database when left out, and FD beyond 8 bytes"
_BYTES = "length of its frames where it is longer than in the database; the rest is padding, sent as 0"


class FrameEntry(Checked):
    """What kind of frame carries a message, where the database does not say."""

    fd: bool | None = Field(default=None, description=_FD)
    bytes: Annotated[int, Field(ge=1, le=64)] | None = Field(default=None, description=_BYTES)


def _of_a_state(what: str) -> Any:
    return Field(default=None, ge=0, description=f"{what}, as in the system description")


class StateMachineSection(Checked):
    """AUTOSAR's E2E state machine: how many of the last checks count in each state, and what they must have found."""

    window_size_init: int | None = _of_a_state("checks that count in INIT")
    window_size_valid: int | None = _of_a_state("checks that count in VALID, the largest window")
    window_size_invalid: int | None = _of_a_state("checks that count in INVALID")
    min_ok_state_init: int | None = _of_a_state("good ones that lead from INIT to VALID")
    max_error_state_init: int | None = _of_a_state("wrong ones that INIT allows")
    min_ok_state_valid: int | None = _of_a_state("good ones that keep VALID")
    max_error_state_valid: int | None = _of_a_state("wrong ones that VALID allows")
    min_ok_state_invalid: int | None = _of_a_state("good ones that lead from INVALID to VALID")
    max_error_state_invalid: int | None = _of_a_state("wrong ones that this way allows")
    clear_from_valid_to_invalid: bool | None = Field(
        default=None, description="whether checks before INVALID are forgotten; no when left out"
    )


class ProtectionSection(Checked):
    """AUTOSAR end-to-end protection of a message; which keys go together is checked with the message's length."""

    profile: int | None = Field(default=None, description="E2E profile", json_schema_extra={"enum": list(E2E_PROFILES)})
    data_id: int | None = Field(default=None, ge=0, description="number of the message that both ends know")
    data_id_list: list[int] | None = Field(
        default=None, description="16 numbers from 0 to 255 instead of data_id, profile 2"
    )
    offset: int | None = Field(default=None, ge=0, description="byte at which the header starts; 0 when left out")
    max_delta_counter: int | None = Field(
        default=None, ge=1, description="largest accepted step of the counter; 1: no loss"
    )
    data_id_mode: str | None = Field(
        default=None, description="how data_id enters the checksum", json_schema_extra={"enum": list(DATA_ID_MODES)}
    )
    state_machine: StateMachineSection | None = Field(
        default=None, description="AUTOSAR's E2E state machine; each frame is judged alone when left out"
    )

    def settings(self) -> dict[str, Any]:
        """Return the keys that are given."""
        return self.model_dump(exclude_unset=True)


class ReceivedEntry(FrameEntry):
    """A message that is taken in; without `timeout_ms` it may stay away for ten cycle times."""

    holes_inside: ClassVar[bool] = True

    signals: dict[str, tuple[SignalEntry, ...]] = Field(default={})
    conditions: dict[str, ConditionEntry] = Field(default={})
    timeout_ms: Milliseconds | None = Field(
        default=None, description="after how long without it its message counts as lost; 0: it may stay away"
    )
    protection: ProtectionSection | None = Field(default=None, description="end-to-end protection of the message")

    @model_validator(mode="after")
    def _something(self) -> Self:
        if self.signals == {} and self.conditions == {}:
            raise wrong(text="key 'signals' is missing")
        return self

    def targets(self) -> list[tuple[str, tuple[str, ...]]]:
        """Return the signals of the plant that the message sets, each with the keys at which it is written."""
        lines = [
            (each.signal, ("signals", name))
            for name, entries in (self.signals or {}).items()
            for each in entries or ()
            if each is not None
        ]
        return [*lines, *((name, ("conditions", name)) for name in self.conditions or {})]


class SentEntry(FrameEntry):
    """A message that is sent; by default at the database's cycle time."""

    holes_inside: ClassVar[bool] = True

    signals: dict[str, tuple[SignalEntry, ...]]
    period_ms: Milliseconds | None = Field(default=None, description="how often it is sent; 0: on change only")
    offset_ms: Milliseconds = Field(default=0.0, description="by how much its period begins later than tick 0")
    on_change: list[str] = Field(default=[], description="signals whose change sends it in the same tick")
    protection: ProtectionSection | None = Field(default=None, description="end-to-end protection of the message")


class CommandEntry(ReceivedEntry):
    """A message that commands the plant."""

    signals: Inputs = Field(default={}, description=_SIGNALS)  # type: ignore[assignment]
    conditions: dict[InputName, ConditionEntry] = Field(default={}, description=_CONDITIONS)


class ReportEntry(SentEntry):
    """A message that shows the plant."""

    signals: Published = Field(description=_SIGNALS)  # type: ignore[assignment]
    on_change: list[PublishedName] = Field(default=[], description="signals whose change sends it in the same tick")


class StalkMessageEntry(ReceivedEntry):
    """A message from the stalk to the ECU."""

    signals: Stalk = Field(  # type: ignore[assignment]
        default={}, description="signal of the database: signal of the stalk"
    )
    conditions: dict[StalkName, ConditionEntry] = Field(default={}, description=_CONDITIONS)


class EcuStatusMessageEntry(SentEntry):
    """A message in which the ECU tells of itself."""

    signals: EcuStatus = Field(description="signal of the database: what the ECU tells")  # type: ignore[assignment]
    on_change: list[EcuStatusName] = Field(default=[], description="signals whose change sends it in the same tick")


class BusSection(Container):
    """The plant on its bus."""

    interface: InterfaceSection = Field(description="CAN interface with its arguments, as python-can takes them")
    database: Annotated[Name, MayBeHole] = Field(description="file of the bus database: DBC, ARXML, KCD, SYM")
    receive: Annotated[dict[str, CommandEntry], MayBeHole] = Field(
        default={}, description="messages that command the plant"
    )
    send: Annotated[dict[str, ReportEntry], MayBeHole] = Field(default={}, description="messages that show the plant")
    timeout_ms: Annotated[Milliseconds | None, MayBeHole] = Field(
        default=None, description="that of messages that have none and no cycle time in the database"
    )
    safe: InputValues = Field(
        default={}, description="what inputs become while commands are lost; relays open unless named"
    )
