"""What a fault is: a name, its quantities, and the elements of the parameters that it changes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from hilplant.checked_yaml.problems import suggestion
from hilplant.failure import Failure

Kind = Literal["electrical", "relay", "park switch", "sensor", "motor", "mechanical"]
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
class FaultDefinition:
    """One entry of the catalogue; `effect` is its equation or truth table in words."""

    name: str
    kind: Kind
    meaning: str
    effect: str
    changes: tuple[Change, ...]
    quantities: tuple[Quantity, ...] = ()

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
