"""Expectations as they are written, in a scenario file or in Python: the same keys in both."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import ConfigDict, Field, model_validator

from hilplant.checked_yaml.checked import Checked, NotNegative, wrong
from hilplant.checked_yaml.problems import suggestion
from hilplant.verdicts.limits import Conditions, Limits, Pair, Value

#: What every wait is limited to that says nothing else [s].
DEFAULT_WAIT_S = 10.0

#: A time [s], a mark's name, or a condition; or a list of them, followed one after the other.
Instant = Value | Conditions
Instants = Instant | Annotated[list[Instant], Field(min_length=1)]


def _limits_of(entry: "Written") -> Limits:
    return Limits.model_validate({key: getattr(entry, key, None) for key in Limits.model_fields})


class Written(Checked):
    """What all expectations may say: `title`, and the window."""

    model_config = ConfigDict(populate_by_name=True)

    key: ClassVar[str]
    title: str = ""
    after: Instants | None = None
    until: Instants | None = None
    while_: Annotated[Conditions | None, Field(alias="while")] = None

    @property
    def subject(self) -> Any:
        """What stands behind the key that names the kind."""
        return getattr(self, self.key)

    @property
    def limits(self) -> Limits:
        """The limits that stand beside the subject."""
        return _limits_of(self)

    def text(self) -> str:
        """Return it as one line of YAML: the kind first, the window last."""
        written = self.model_dump(by_alias=True, exclude_unset=True, exclude={"title"})
        order = ["within", self.key, *written] if "signal" in written else [self.key, *written]
        window = [key for key in ("after", "until", "while") if key in written]
        keys = dict.fromkeys([*(key for key in order if key in written and key not in window), *window])
        return ", ".join(f"{key}: {_flow(written[key])}" for key in keys)


class _Limited(Written):
    below: Value | None = None
    above: Value | None = None
    between: Pair | None = None
    equals: Value | None = None
    tolerance: NotNegative | None = None

    @model_validator(mode="after")
    def _limits_sound(self) -> "_Limited":
        stated = _limits_of(self).stated
        if isinstance(self.subject, str) and not stated:
            raise wrong(self.key, text=f"{self.key}: say what of {self.subject}: below, above, between or equals")
        if isinstance(self.subject, dict) and stated:
            group = f"{{{next(iter(self.subject))}: 1}}"
            raise wrong(self.key, text=f"{self.key}: limits stand within the group, as {group}")
        return self


Subject = str | Conditions


class AlwaysEntry(_Limited):
    """The condition holds at every tick."""

    key: ClassVar[str] = "always"
    always: Subject


class NeverEntry(_Limited):
    """The condition holds at no tick."""

    key: ClassVar[str] = "never"
    never: Subject


class WithinEntry(_Limited):
    """The condition holds at some tick within a time [s]."""

    key: ClassVar[str] = "signal"
    within: NotNegative
    signal: Subject


class SettlesEntry(Written):
    """The signal comes to a value within `by` [s], and stays there for `hold` [s], or to the window's end."""

    key: ClassVar[str] = "settles"
    settles: str
    to: Value
    tolerance: NotNegative
    by: NotNegative
    hold: NotNegative | None = None


class StaysEntry(Written):
    """The signal stays where it is at the window's begin, for a time `hold` [s] or to the window's end."""

    key: ClassVar[str] = "stays"
    stays: str
    tolerance: NotNegative = 0.0
    hold: NotNegative | None = None


class ResponseEntry(Written):
    """Whenever the condition begins to hold, another one holds within a time [s]."""

    key: ClassVar[str] = "response"
    response: Conditions
    then: Conditions
    within: NotNegative = DEFAULT_WAIT_S


class RisesEntry(Written):
    """The signal rises through a level within a time [s]."""

    key: ClassVar[str] = "rises"
    rises: str
    through: float = 0.5
    within: NotNegative = DEFAULT_WAIT_S


class FallsEntry(Written):
    """The signal falls through a level within a time [s]."""

    key: ClassVar[str] = "falls"
    falls: str
    through: float = 0.5
    within: NotNegative = DEFAULT_WAIT_S


class CountEntry(_Limited):
    """How often the condition begins to hold."""

    key: ClassVar[str] = "count"
    count: Conditions

    @model_validator(mode="after")
    def _limits_sound(self) -> "CountEntry":
        if not _limits_of(self).stated:
            raise wrong("count", text="count: say how often: equals, between, below or above")
        return self


class FramesEntry(Written):
    """A rule for the frames of a message; one of the keys below `frames`."""

    key: ClassVar[str] = "frames"
    frames: str
    period_ms: Pair | None = None
    jitter_ms: NotNegative | None = None
    missing: Annotated[int, Field(ge=0)] | None = None
    counter: Literal["right"] | None = None
    crc: Literal["right"] | None = None
    wrong: Annotated[int, Field(ge=0)] = 0

    @model_validator(mode="after")
    def _one_rule(self) -> "FramesEntry":
        if len(self.rules) != 1:
            raise wrong("frames", text="frames needs one of period_ms, jitter_ms, missing, counter, crc")
        if self.while_ is not None:
            raise wrong("while", text="frames are judged from after to until, without while")
        return self

    @property
    def rules(self) -> list[str]:
        """Which rules are asked for."""
        known = ("period_ms", "jitter_ms", "missing", "counter", "crc")
        return [name for name in known if getattr(self, name) is not None]


#: The kinds by their keys; where an entry has several of these keys, the first names it.
KINDS: dict[str, type[Written]] = {
    kind.key: kind
    for kind in (
        AlwaysEntry,
        NeverEntry,
        SettlesEntry,
        StaysEntry,
        ResponseEntry,
        RisesEntry,
        FallsEntry,
        CountEntry,
        FramesEntry,
    )
} | {"within": WithinEntry}


def kind_of(entry: dict[str, Any]) -> type[Written]:
    """Return the description of an entry, by the key that names its kind; ValueError when there is none."""
    for key, kind in KINDS.items():
        if key in entry:
            return kind
    first = next(iter(entry), "")
    raise ValueError(f"an expectation is one of {', '.join(KINDS)}{_near(first)}")


def _near(word: str) -> str:
    near = suggestion(str(word), KINDS)
    return near if near.endswith("?") else f", not '{word}'"


def _flow(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_flow(item) for item in value) + "]"
    return f"{value:g}" if isinstance(value, float) else str(value)
