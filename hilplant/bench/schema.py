"""JSON Schema (draft 2020-12) of the files that people write, for editors and for checks without hilplant.

Everything comes from the descriptions: keys, ranges, defaults and words. The unit of a number follows from its key.
"""

from collections.abc import Mapping
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from hilplant.bench.controller_file import ControllerFile
from hilplant.bench.description import BenchDescription
from hilplant.bench.ecu_description import EcuSettings
from hilplant.bench.parts import LinkageFile, MotorFile
from hilplant.bench.screen_parts import ScreenFile
from hilplant.checked_yaml.checked import Checked

Schema = dict[str, Any]

#: Kinds of files with their description, and the version of what they may say; a key that goes raises it.
KINDS: Mapping[str, tuple[type[Checked], int]] = {
    "bench": (BenchDescription, 1),
    "motor": (MotorFile, 1),
    "linkage": (LinkageFile, 1),
    "screen": (ScreenFile, 1),
    "ecu": (EcuSettings, 1),
    "controller": (ControllerFile, 1),
}

#: Units by the end of a key; a longer end goes before a shorter one.
UNITS = {
    "_kg_m2": "kg m2", "_n_m_rad": "N m/rad", "_n_m_s": "N m s/rad", "_rad_s": "rad/s", "_mm_s": "mm/s",
    "_v_s": "V s/rad", "_n_m": "N m", "_m_s": "m/s", "_henry": "H", "_ohm": "ohm", "_deg": "deg", "_rad": "rad",
    "_m2": "m2", "_kg": "kg", "_ms": "ms", "_n": "N", "_m": "m", "_s": "s", "_v": "V", "_a": "A", "_j_k": "J/K",
    "_w_k": "W/K", "_percent_k": "%/K", "_percent_s": "%/s", "_percent": "%", "_mm_h": "mm/h", "_mm": "mm",
    "_c": "degC",
}  # fmt: skip

#: Groups whose keys a bench may inherit.
_INHERITING = ("plant", "bus")


def schema_of(kind: str, model: type[Checked], version: int) -> Schema:
    """Return the schema of a kind of file."""
    made = model.model_json_schema(schema_generator=GenerateJsonSchema)
    _finish(made)
    inherited = _inherited(kind, made)
    head = {
        "$schema": GenerateJsonSchema.schema_dialect,
        "$id": f"urn:hilplant:schema:{kind}:{version}",
        "title": f"hilplant {kind}",
    }
    return head | {key: value for key, value in made.items() if key not in head} | inherited


def _inherited(kind: str, made: Schema) -> Schema:
    """Demand of a bench that extends none what no other can give; return what its schema says of that."""
    if kind != "bench":
        return {}
    for name in _INHERITING:
        made["properties"][name].pop("required", None)
    needed = made.pop("required")
    return {"if": {"not": {"required": ["extends"]}}, "then": {"required": needed}}


def _finish(schema: Any) -> None:
    """Add the units of numbers, and take away titles that only repeat a key."""
    for inner in schema.values() if isinstance(schema, dict) else schema if isinstance(schema, list) else ():
        _finish(inner)
    properties = schema.get("properties") if isinstance(schema, dict) else None
    for key, described in properties.items() if isinstance(properties, dict) else ():
        if isinstance(described, dict):
            described.pop("title", None)
            if "properties" in described:
                described.pop("default", None)  # its keys have theirs
            if (unit := unit_of(key)) and "x-unit" not in described and "properties" not in described:
                described["x-unit"] = unit


def unit_of(key: str) -> str | None:
    """Return the unit that a key ends with."""
    return next((unit for end, unit in UNITS.items() if key.endswith(end)), None)
