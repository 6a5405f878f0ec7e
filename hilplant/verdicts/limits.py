"""Limits and conditions on signals as they are written; faults and expectations have them alike."""

from typing import Annotated

from pydantic import Field, model_validator

from hilplant.checked_yaml.checked import Checked, NotNegative, wrong

Value = bool | int | float | str
#: A signal's value, one of its labels, `rises` or `falls`, or a group of limits.
Part = Value | dict[str, Value | list[float]]
Conditions = Annotated[dict[str, Part], Field(min_length=1)]
Pair = Annotated[list[float], Field(min_length=2, max_length=2)]


class Limits(Checked):
    """What a value may be; limits are included."""

    below: Value | None = None
    above: Value | None = None
    between: Pair | None = None
    equals: Value | None = None
    tolerance: NotNegative | None = None

    @model_validator(mode="after")
    def _sound(self) -> "Limits":
        if self.equals is not None and {self.below, self.above, self.between} != {None}:
            raise wrong("equals", text="equals stands alone, with tolerance at most")
        if self.tolerance is not None and self.equals is None:
            raise wrong("tolerance", text="tolerance needs equals")
        if self.between is not None and self.between[0] > self.between[1]:
            raise wrong("between", text="between must be [lowest, highest]")
        return self

    @property
    def stated(self) -> bool:
        """Whether anything is asked."""
        return any(value is not None for value in (self.below, self.above, self.between, self.equals))
