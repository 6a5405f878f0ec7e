"""Written conditions and limits -> levels and edges of known signals; a name that nobody knows is a ValueError."""

import math
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from hilplant.checked_yaml.problems import suggestion
from hilplant.verdicts.expectations import Condition, Edge, Level
from hilplant.verdicts.known import Known, KnownSignal
from hilplant.verdicts.limits import Limits


def condition_of(parts: Mapping[str, Any], known: Known) -> Condition:
    """Return what must hold together; ValueError for names that nobody knows, and for limits that say nothing."""
    return tuple(_part(name, part, known) for name, part in parts.items())


def _part(name: str, part: Any, known: Known) -> Level | Edge:
    if part in ("rises", "falls"):
        return Edge(known_name(name, known), part == "rises")
    if not isinstance(part, dict):
        return level_of(name, Limits(equals=part), known)
    crossing = {"rises", "falls"} & set(part)
    if crossing:
        level = part[crossing.pop()]
        if len(part) > 1 or isinstance(level, bool) or not isinstance(level, int | float):
            raise ValueError(f"{name}: write {{rises: LEVEL}} or {{falls: LEVEL}} alone")
        return Edge(known_name(name, known), "rises" in part, float(level))
    try:
        limits = Limits.model_validate(part)
    except ValidationError as error:
        raise ValueError(f"{name}: {error.errors()[0]['msg']}") from None
    if not limits.stated:
        raise ValueError(f"{name}: say what of it: below, above, between or equals")
    return level_of(name, limits, known)


def level_of(name: str, limits: Limits, known: Known) -> Level:
    """Return the level of a signal that obeys limits; ValueError for names that nobody knows."""
    signal = known.signals[known_name(name, known)]
    tolerance = limits.tolerance if limits.tolerance is not None else 0.5 if signal.discrete else 0.0
    lowest, highest = bounds(limits, tolerance, (name, signal))
    return Level(name, lowest, highest)


def bounds(limits: Limits, tolerance: float, named: tuple[str, KnownSignal] | None) -> tuple[float, float]:
    """Return the lowest and highest value that obey limits; a signal that is `named` may have labels."""
    if limits.equals is not None:
        wanted = _number(limits.equals, named)
        tolerance = tolerance if named else limits.tolerance or 0.0
        return wanted - tolerance, wanted + tolerance
    lowest = -math.inf if limits.above is None else _number(limits.above, named)
    highest = math.inf if limits.below is None else _number(limits.below, named)
    if limits.between is not None:
        lowest, highest = max(lowest, limits.between[0]), min(highest, limits.between[1])
    return lowest, highest


def _number(value: Any, named: tuple[str, KnownSignal] | None) -> float:
    if not isinstance(value, str):
        return float(value)
    labels = {} if named is None else {label.lower(): number for label, number in named[1].labels.items()}
    if value.lower() not in labels:
        told = suggestion(value.lower(), labels) if labels else "; it has numbers only"
        raise ValueError(f"{named[0] if named else 'count'} has no value '{value}'{told}")
    return labels[value.lower()]


def known_name(name: str, known: Known) -> str:
    """Return the name of a signal; ValueError when nobody knows it."""
    if name not in known.signals:
        near = suggestion(name, known.signals)
        raise ValueError(f"no signal '{name}'{near if near.endswith('?') else ''}; docs/testing.md lists what there is")
    return name
