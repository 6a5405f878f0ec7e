"""The three stages one by one, as the three buttons of 8.3.6: which are wanted, and what is found without the third."""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.identify.cost import Cost
from hilplant.identify.genetic import Generation, Outcome
from hilplant.identify.validation import Comparison

TRANSFER_FUNCTION, GLOBAL_SEARCH, LEAST_SQUARES = 1, 2, 3
ALL = (TRANSFER_FUNCTION, GLOBAL_SEARCH, LEAST_SQUARES)


def parse_stages(text: str) -> tuple[int, ...]:
    """Return the stages that a text such as `1,2` names, in their order.

    Raises
    ------
    Failure
        For anything else than some of 1, 2 and 3.

    """
    try:
        found = sorted({int(part) for part in text.split(",")})
    except ValueError:
        found = []
    if not found or not set(found) <= set(ALL):
        raise Failure(f"--stages: some of 1, 2, 3 with commas between are wanted, such as 1,2, not '{text}'")
    return tuple(found)


class StagedValues(NamedTuple):
    """What some stages without the last one found: values and cost, without intervals; the search if there was one."""

    values: Floats
    cost: float
    outcome: Outcome | None
    row: Floats
    fitted: list[Comparison]
    held_out: list[Comparison]
    seconds: float


def no_search(cost: Cost, values: Floats) -> Outcome:
    """Return what the global search would say had it stayed where it began."""
    found = float(cost(values[np.newaxis])[0])
    return Outcome(values.copy(), found, (Generation(1, found, found),))
