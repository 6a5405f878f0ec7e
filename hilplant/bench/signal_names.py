"""Names and values of signals as a description holds them, with what the schema says of them."""

from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import AfterValidator, GetJsonSchemaHandler, ValidationError
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, InitErrorDetails, PydanticCustomError

from hilplant.bench.values import input_index, signal_value
from hilplant.checked_yaml.checked import MayBeHole, Name
from hilplant.declaration import Signal
from hilplant.signals import ECU_STATUS, INPUTS, PUBLISHED, STALK


class OneOf:
    """Lets the schema offer the names of signals; whether a name is right is checked where its message is."""

    def __init__(self, signals: Sequence[Signal]) -> None:
        self._names = [signal.name for signal in signals]

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Return what the schema says."""
        return {"type": "string", "enum": self._names}


InputName = Annotated[Name, OneOf(INPUTS)]
PublishedName = Annotated[Name, OneOf(PUBLISHED)]
StalkName = Annotated[Name, OneOf(STALK)]
EcuStatusName = Annotated[Name, OneOf(ECU_STATUS)]


class _ByInput:
    """Lets the schema offer every input of the plant with the values that it may have."""

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Return what the schema says."""
        properties = {signal.name: value_schema(signal) for signal in INPUTS}
        return {"type": "object", "properties": properties, "additionalProperties": False}


def value_schema(signal: Signal) -> JsonSchemaValue:
    """Return what a value of a signal may be, as people write it."""
    head = {"description": signal.meaning} | ({"x-unit": signal.unit} if signal.unit else {})
    if signal.kind == "flag":
        return head | {"type": "boolean", "default": bool(signal.default)}
    if signal.kind == "choice":
        return head | {"enum": list(signal.choices)}
    number = {"type": "number", "minimum": signal.minimum, "maximum": signal.maximum}
    if not signal.names:
        return head | number | {"default": signal.default}
    return head | {"anyOf": [number, {"enum": [name for name, _ in signal.names]}], "default": signal.default}


def _check_values(written: dict[str, Any]) -> dict[str, Any]:
    wrong = []
    for name, value in written.items():
        try:
            signal_value(INPUTS[input_index(name)], value)
        except ValueError as error:
            kind = PydanticCustomError("wrong", "{text}", {"text": str(error), "at": ()})
            wrong.append(InitErrorDetails(type=kind, loc=(name,), input=value))
    if wrong:
        raise ValidationError.from_exception_data("inputs", wrong)
    return written


#: Values of inputs of the plant by their names, as they are written.
InputValues = Annotated[dict[str, Any], AfterValidator(_check_values), _ByInput(), MayBeHole]
