"""What a bench may say of how signals of the database relate to those of the plant, the stalk and the ECU."""

from typing import Annotated, Any, Self, TypeVar

from pydantic import BeforeValidator, Field, GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from hilplant.bench.signal_names import EcuStatusName, InputName, PublishedName, StalkName
from hilplant.checked_yaml.checked import Checked, Name, Real, shown_value, wrong, wrong_value


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
