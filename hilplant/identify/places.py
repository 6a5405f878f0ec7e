"""Where a named element of nested records is in their packed row (``models/records.py``)."""

from typing import Any, get_type_hints

from hilplant.models.records import Parameters, State


def places(record: type[Any], prefix: str = "") -> dict[str, int]:
    """Return the place of each element by its name, with a point between those of inner records.

    What lies behind an element of unknown length has no place that could be told.
    """
    found: dict[str, int] = {}
    for name, kind in get_type_hints(record).items():
        if kind is float:
            found[prefix + name] = len(found)
        elif hasattr(kind, "_fields"):
            found |= {inner: len(found) + place for inner, place in places(kind, f"{prefix}{name}.").items()}
        else:
            break
    return found


PLACE = places(Parameters)
STATE_PLACE = places(State)
