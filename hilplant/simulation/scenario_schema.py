"""What the schema says of a scenario file."""

from typing import Any

from pydantic import GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from hilplant.bench.signal_names import value_schema
from hilplant.signals import INPUTS

_TIME: JsonSchemaValue = {"type": "number", "minimum": 0, "description": "time from the start [s]"}


class EntriesOfInputs:
    """Lets the schema offer every input of the plant, with pairs of time and value or ramp."""

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Return what the schema says."""
        return {
            "type": "object",
            "additionalProperties": False,
            "properties": {
                signal.name: _entries(value_schema(signal), ramps=signal.kind == "real") for signal in INPUTS
            },
        }


def _entries(value: JsonSchemaValue, *, ramps: bool) -> JsonSchemaValue:
    described: dict[str, Any] = {key: value.pop(key) for key in ("description", "x-unit") if key in value}
    value.pop("default", None)
    ramp = {
        "type": "object",
        "additionalProperties": False,
        "required": ["ramp_to", "seconds"],
        "properties": {
            "ramp_to": value | {"description": "value at the end of the ramp"},
            "seconds": {"type": "number", "exclusiveMinimum": 0, "x-unit": "s", "description": "length of the ramp"},
        },
    }
    second = {"anyOf": [value, ramp]} if ramps else value
    pair = {"type": "array", "prefixItems": [_TIME, second], "minItems": 2, "maxItems": 2}
    return described | {"type": "array", "items": pair}
