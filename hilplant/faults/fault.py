"""What a fault is: a name, its quantities, and the elements of the parameters that it changes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from hilplant.bus.frame_fault import FrameFault
from hilplant.checked_yaml.problems import suggestion
from hilplant.failure import Failure

Kind = Literal["electrical", "relay", "park switch", "sensor", "motor", "mechanical", "bus"]
#: How a change meets what is there: added to it, a factor on it, or in its place.
Way = Literal["add", "scale", "set"]
Values = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Quantity:
    """One number that a fault takes: its unit is the end of its name; `default` None: it must be given."""

    name: str
    minimum: float
    maximum: float
    meaning: str
    default: float | None = None


@dataclass(frozen=True, slots=True)
class Change:
    """What becomes of one element of the packed parameters, named as in ``records.PARAMETER_INDEX``.

    `value` makes the number from the fault's quantities; times in seconds become ticks by the length of a step.
    """

    element: str
    way: Way
    value: Callable[[Values, float], float]


@dataclass(frozen=True, slots=True)
class About:
    """What a fault of the bus is about; `direction` is "to plant" or "from plant"; a message has one of its own."""

    message: str | None = None
    signal: str | None = None
    value: float | None = None
    direction: str | None = None


#: What a fault of the plant is about.
NOTHING = About()


@dataclass(frozen=True, slots=True)
class FaultDefinition:
    """One entry of the catalogue; `effect` is its equation or truth table in words.

    A fault of the bus changes no parameters but frames: `on_frames` is what becomes of them, and `about` which of
    message, signal and value it has to be given, besides a message or a direction.
    """

    name: str
    kind: Kind
    meaning: str
    effect: str
    changes: tuple[Change, ...]
    quantities: tuple[Quantity, ...] = ()
    on_frames: type[FrameFault] | None = None
    about: tuple[str, ...] = ()

    def complete(self, given: Mapping[str, float]) -> dict[str, float]:
        """Return the value of every quantity, defaults included.

        Raises
        ------
        Failure
            For a quantity that it does not have, that is missing, or that is out of range.

        """
        known = {quantity.name: quantity for quantity in self.quantities}
        for name in given:
            if name not in known:
                takes = suggestion(name, known) or "; it takes none"
                raise Failure(f"fault '{self.name}' has no quantity '{name}'{takes}")
        values: dict[str, float] = {}
        for name, quantity in known.items():
            value = given.get(name, quantity.default)
            if value is None:
                raise Failure(f"fault '{self.name}' needs {name}, {quantity.meaning}")
            if not quantity.minimum <= value <= quantity.maximum:
                raise Failure(
                    f"{name} of fault '{self.name}' lies between {quantity.minimum:g} and {quantity.maximum:g}, "
                    f"not {value:g}"
                )
            values[name] = float(value)
        return values

    def check_about(self, about: About) -> None:
        """Refuse what it cannot be about, and what is missing.

        Raises
        ------
        Failure
            Naming the key.

        """
        given = {name for name in ("message", "signal", "value", "direction") if getattr(about, name) is not None}
        if self.on_frames is None and given:
            raise Failure(f"fault '{self.name}' is none of the bus; it takes no {min(given)}")
        may = set() if "direction" in self.about else {"message", "direction"}
        for name in sorted(given - may - set(self.about)):
            raise Failure(f"fault '{self.name}' takes no {name}")
        for name in self.about:
            if name != "protection" and name not in given:
                raise Failure(f"fault '{self.name}' needs {name}: {ABOUT[name]}")
        if self.on_frames is not None and not given & {"message", "direction"}:
            raise Failure(f"fault '{self.name}' needs message or direction: {ABOUT['direction']}")


#: What a fault of the bus may have to be told.
ABOUT = {
    "message": "a message of the bench that the plant hears or sends",
    "signal": "one of the message's signals",
    "value": "what the signal says instead, in its unit",
    "direction": "to plant (the ECU's frames), or from plant",
}
