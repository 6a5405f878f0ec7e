"""The base of all descriptions: strict pydantic models whose errors say what would be right."""

from collections.abc import Iterator, Sequence
from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field, ModelWrapValidatorHandler, ValidationError, model_validator
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

from hilplant.checked_yaml.problems import Problem, suggestion
from hilplant.checked_yaml.yaml_reader import Document, Location

Real = float
Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
Name = Annotated[str, Field(min_length=1)]

#: Of a longer value a message shows the beginning.
_LONGEST_SHOWN = 60

_WORDING = {
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "int_from_float": "must be a whole number",
    "bool_type": "must be true or false",
    "string_type": "must be text",
    "string_too_short": "must not be empty",
    "finite_number": "must be a finite number",
    "dict_type": "must be a group of keys",
    "model_type": "must be a group of keys",
    "model_attributes_type": "must be a group of keys",
    "list_type": "must be a list",
    "tuple_type": "must be a list",
}


class Checked(BaseModel):
    """A group of keys in a file: nothing unknown, nothing converted, nothing changed afterwards."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    @model_validator(mode="wrap")
    @classmethod
    def _reword(cls, value: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Reword this group's own errors, here where its keys are at hand; inner groups have done theirs."""
        try:
            return handler(value)
        except ValidationError as error:
            details = [_reworded(detail, set(cls.model_fields)) for detail in error.errors(include_url=False)]
            raise ValidationError.from_exception_data(cls.__name__, details) from None


def wrong(*location: str | int, text: str) -> PydanticCustomError:
    """Return an error, to be raised by a validator, that points at a key within the validated group."""
    return PydanticCustomError("wrong", "{text}", {"text": text, "at": location})


def problems_of(error: ValidationError, document: Document, location: Location) -> Iterator[Problem]:
    """Turn what pydantic found below `location` into problems with file and line."""
    for detail in error.errors(include_url=False):
        steps = (*detail["loc"], *detail.get("ctx", {}).get("at", ()))
        yield document.problem(_existing(document, location, steps), detail["msg"])


def _reworded(detail: ErrorDetails, known: set[str]) -> InitErrorDetails:
    context = {"text": _text(detail, known), "at": detail.get("ctx", {}).get("at", ())}
    kind = PydanticCustomError("wrong", "{text}", context)
    return InitErrorDetails(type=kind, loc=detail["loc"], input=detail["input"])


def _text(detail: ErrorDetails, known: set[str]) -> str:
    kind, value = detail["type"], detail["input"]
    key = _called(detail["loc"])
    if kind == "wrong":
        return detail["msg"]
    if kind == "extra_forbidden":
        return f"unknown key '{key}'{suggestion(key, known)}"
    if kind == "missing":
        return f"key '{key}' is missing"
    if kind.startswith("union_tag"):
        return _tag_text(detail, key)
    if kind in ("too_short", "too_long"):
        return f"{key} {_length_text(detail)}"
    wording = _WORDING.get(kind) or detail["msg"].replace("Input should be", "must be", 1)
    return f"{key} {wording}, not {_shown(value)}".lstrip()


def _called(location: Sequence[str | int]) -> str:
    """Return what a value is called: its key, or its place in a list, counted from 1."""
    if not location:
        return ""
    if isinstance(location[-1], int):
        return f"entry {location[-1] + 1} of {_called(location[:-1])}"
    return location[-1]


def _length_text(detail: ErrorDetails) -> str:
    context = detail["ctx"]
    most = "max_length" in context
    limit = context["max_length" if most else "min_length"]
    entries = "entry" if limit == 1 else "entries"
    return f"must have at {'most' if most else 'least'} {limit} {entries}, not {context['actual_length']}"


def _tag_text(detail: ErrorDetails, key: str) -> str:
    context = detail["ctx"]
    tag = context["discriminator"].strip("'")
    if detail["type"] == "union_tag_not_found":
        return f"{key}: key '{tag}' is missing"
    expected = [word.strip("' ") for word in context["expected_tags"].split(",")]
    return f"unknown {key} {tag} '{context['tag']}'{suggestion(context['tag'], expected)}"


def _shown(value: Any) -> str:
    if isinstance(value, dict | list):
        return "a group of keys" if isinstance(value, dict) else "a list"
    if value is None or isinstance(value, bool):
        return {True: "true", False: "false", None: "nothing"}[value]
    text = repr(value)
    return text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}..."


def _existing(document: Document, location: Location, steps: tuple[str | int, ...]) -> Location:
    """Drop from `steps` what pydantic adds and the file does not hold: names of the choices of a union."""
    for step in steps:
        if (*location, step) in document.places:
            location = (*location, step)
    return location
