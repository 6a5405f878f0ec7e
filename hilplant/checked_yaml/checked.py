"""The base of all descriptions: strict pydantic models whose errors say what would be right."""

from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from typing import Annotated, Any, ClassVar, NamedTuple

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)
from pydantic_core import CoreSchema, ErrorDetails, InitErrorDetails, PydanticCustomError, core_schema

from hilplant.checked_yaml.draft import HOLE, Draft
from hilplant.checked_yaml.problems import suggestion
from hilplant.checked_yaml.yaml_reader import Location

Real = float
Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
Name = Annotated[str, Field(min_length=1)]

#: Of a longer value a message shows the beginning.
_LONGEST_SHOWN = 60
#: No key of ours is longer.
_LONGEST_KEY = 60

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

    #: In a draft: whether it may have holes inside, and whether it goes on without what is wrong with its own keys.
    holes_inside: ClassVar[bool] = False
    survives: ClassVar[bool] = False

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Reword this group's own errors, here where its keys are at hand; inner groups have done theirs."""
        return core_schema.with_info_wrap_validator_function(
            lambda value, inner, info: _collected(value, inner, info, cls), handler(source)
        )


class Container(Checked):
    """A group whose parts are checked against each other even while some of its keys are wrong."""

    holes_inside: ClassVar[bool] = True
    survives: ClassVar[bool] = True


def _collected(value: Any, handler: Callable[[Any], Any], info: ValidationInfo, model: type[Checked] | None) -> Any:
    """Validate a value; in a draft, mistakes are kept there and the value becomes a hole, which is None."""
    draft = info.context if isinstance(info.context, Draft) else None
    if draft is not None and value is HOLE:
        return draft.hole()
    at = draft.location(value) if draft is not None else None
    before = draft.holes if draft is not None else 0
    known = keys_of(model) if model is not None else set()
    try:
        whole = handler(value)
        sound = draft is None or draft.holes == before or model is None or model.holes_inside
        return whole if sound else None
    except ValidationError as error:
        if not isinstance(value, dict) and at is None:
            raise  # the group around knows what the value is called
        mistakes = [_mistake(detail, known, at or ()) for detail in error.errors(include_url=False)]
        if draft is None or at is None:
            title = model.__name__ if model is not None else "value"
            raise ValidationError.from_exception_data(title, [mistake.details() for mistake in mistakes]) from None
    for mistake in mistakes:
        draft.note((*at, *mistake.location, *mistake.inner), mistake.text)
    if model is None or not model.survives:
        return draft.hole()
    wrong_keys = {mistake.location[0] for mistake in mistakes if mistake.location}
    right = {key: inner for key, inner in value.items() if key not in wrong_keys}
    return _first_sound(handler, right | dict.fromkeys(wrong_keys & known, HOLE), right)


def keys_of(model: type[BaseModel]) -> set[str]:
    """Return the keys of a group as they stand in a file."""
    return {field.alias or name for name, field in model.model_fields.items()}


def _first_sound(handler: Callable[[Any], Any], *groups: dict[str, Any]) -> Any:
    for group in groups:
        with suppress(ValidationError):
            return handler(group)
    return None


def _in_a_draft(value: Any, handler: ValidatorFunctionWrapHandler, info: ValidationInfo) -> Any:
    return _collected(value, handler, info, None)


#: Marks what is no group, or a choice of groups, and may be a hole in a draft.
MayBeHole = WrapValidator(_in_a_draft)


def wrong(*location: str | int, text: str) -> PydanticCustomError:
    """Return an error, to be raised by a validator, that points at a key within the validated group."""
    return PydanticCustomError("wrong", "{text}", {"text": text, "at": location})


def wrong_value(text: str) -> PydanticCustomError:
    """Return an error whose text follows the name of the value that is validated."""
    return PydanticCustomError("wrong_value", "{text}", {"text": text})


class _Mistake(NamedTuple):
    """One error: where pydantic saw it, where within that it is, what is wrong, and the value."""

    location: Location
    inner: Location
    text: str
    value: Any

    def details(self) -> InitErrorDetails:
        """Return it as an error that is passed on."""
        kind = PydanticCustomError("wrong", "{text}", {"text": self.text, "at": self.inner})
        return InitErrorDetails(type=kind, loc=self.location, input=self.value)


def _mistake(detail: ErrorDetails, known: set[str], at: Location) -> _Mistake:
    inner = tuple(detail.get("ctx", {}).get("at", ()))
    return _Mistake(detail["loc"], inner, text_of(detail, known, at), detail["input"])


def text_of(detail: ErrorDetails, known: Collection[str] = (), at: Location = ()) -> str:
    """Return what is wrong in words, for a group of `known` keys that stands `at` a location."""
    kind, value = detail["type"], detail["input"]
    key = _called(detail["loc"] or at)
    if kind in ("wrong", "wrong_value"):
        return detail["msg"] if kind == "wrong" else f"{key} {detail['msg']}"
    if kind == "extra_forbidden":
        return f"unknown key '{key}'{suggestion(key, known)}" if _is_name(key) else "a line that begins with no key"
    if kind == "missing":
        return f"key '{key}' is missing"
    if kind.startswith("union_tag"):
        return _tag_text(detail, key)
    if kind in ("too_short", "too_long"):
        return f"{key} {_length_text(detail)}"
    wording = _WORDING.get(kind) or detail["msg"].replace("Input should be", "must be", 1)
    return f"{key} {wording}, not {shown_value(value)}".lstrip()


def _is_name(key: str) -> bool:
    """Whether a key can be one; a line of a foreign file, such as a password's, is never shown."""
    return len(key) <= _LONGEST_KEY and not set(":=$/+ ") & set(key)


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


def shown_value(value: Any) -> str:
    """Return a value as messages show it: what it is, or its beginning."""
    if isinstance(value, dict | list):
        return "a group of keys" if isinstance(value, dict) else "a list"
    if value is None or isinstance(value, bool):
        return {True: "true", False: "false", None: "nothing"}[value]
    text = repr(value)
    return text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}..."
