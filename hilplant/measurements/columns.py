"""Which column of a file is what: `voltage=U1,current=I1[mA],park=PS`, and the units they come in."""

import re
from collections.abc import Mapping
from typing import NamedTuple

from hilplant.checked_yaml.problems import suggestion
from hilplant.failure import Failure
from hilplant.measurements.measurement import Channel
from hilplant.units import FACTORS, unit_of

#: What a column may be, with the unit it is brought to.
ROLES = {"time": "s", "voltage": "V", "current": "A", "park": "", "fast": "", "on": ""}
REQUIRED = ("voltage", "current", "park")

#: Columns that are found without being named: those of this project's own tables, and plain words.
KNOWN_NAMES = {
    "time": (
        *("time_s", "time", "t", "timestamps", "timestamp", "x_value", "x-axis", "zeit", "datetime", "date/time"),
        *("uhrzeit", "datum", "date"),
    ),
    "voltage": ("terminal_v", "voltage_v", "voltage", "terminalvoltage"),
    "current": ("current_a", "current", "motorcurrent"),
    "park": ("park_contact", "park", "parkcontact", "ps"),
    "fast": ("relay_fast", "fast", "relayfast"),
}

#: Quantities beside the roles of a measurement, that other files hold.
_OWN_UNITS = ROLES | {"speed": "rad/s"}
_ENTRY = re.compile(r"(?P<name>[^\[\]*]+?)\s*(\[(?P<unit>[^\]]*)\])?\s*(\*\s*(?P<factor>\S+))?")
_CLOCK = re.compile(r"(?P<start>[-+]?\d*\.?\d*(?:[eE][-+]?\d+)?):(?P<step>\d*\.?\d+(?:[eE][-+]?\d+)?)")


class Column(NamedTuple):
    """A column by its name in the file; its unit where the user says one, and a factor before it (a current clamp)."""

    name: str
    unit: str | None = None
    factor: float = 1.0


def parse_columns(text: str) -> dict[str, Column]:
    """Read ``role=NAME[unit]*factor,...``; unit and factor may be left out.

    Raises
    ------
    Failure
        Naming the entry and what would be right.

    """
    found: dict[str, Column] = {}
    for entry in filter(None, (part.strip() for part in text.split(","))):
        role, equals, written = (part.strip() for part in entry.partition("="))
        place = f"--columns, '{entry}'"
        if not equals or not written:
            raise Failure(f"{place}: write role=NAME, such as voltage=U1 or current=I1[mA]")
        if role not in ROLES:
            raise Failure(f"{place}: there is no role '{role}'{suggestion(role, ROLES)}")
        if role in found:
            raise Failure(f"{place}: {role} is given twice; keep one")
        found[role] = _column(place, role, written)
    return found


def _column(place: str, role: str, written: str) -> Column:
    match = _ENTRY.fullmatch(written)
    if match is None:
        raise Failure(f"{place}: write NAME, NAME[unit] or NAME[unit]*factor")
    try:
        factor = float(match["factor"]) if match["factor"] else 1.0
    except ValueError:
        raise Failure(f"{place}: '{match['factor']}' is not a number") from None
    if not 0.0 < abs(factor) < float("inf"):
        raise Failure(f"{place}: a factor must be a finite number other than 0")
    column = Column(match["name"], match["unit"], factor)
    unit_scale(place, role, column.unit or "")
    return column


def clock_of(column: Column | None) -> tuple[float, float] | None:
    """Return start and distance of the samples [s] where time=START:STEP says them in place of a column."""
    found = _CLOCK.fullmatch(column.name) if column is not None else None
    if found is None or column is None:
        return None
    scale = unit_scale("--columns, time", "time", column.unit or "") * column.factor
    return scale * float(found["start"] or 0.0), scale * float(found["step"])


def unit_scale(place: str, role: str, unit: str) -> float:
    """Return what a value in `unit` is multiplied with to be in the role's own unit; no unit is that one."""
    own = _OWN_UNITS[role]
    if not own or not unit:
        return 1.0
    unit = unit_of(unit)
    if unit not in FACTORS[own]:
        known = ", ".join(FACTORS[own])
        raise Failure(f"{place}: {role} comes in one of {known}, not in '{unit}'; say it as {role}=NAME[{own}]")
    return FACTORS[own][unit]


def has_unit(role: str, unit: str) -> bool:
    """Say whether a unit is one of those that the role comes in."""
    own = _OWN_UNITS[role]
    return own != "" and unit_of(unit) in FACTORS[own]


def text_columns(texts: Mapping[str, str]) -> str:
    """Return how a sentence about columns ends where some were left out because they hold text."""
    told = ", ".join(f"{name} ('{text[:40]}')" for name, text in texts.items())
    return f"; text, no numbers: {told}" if told else ""


def choose_columns(
    given: Mapping[str, Column], names: Mapping[str, Channel], source: str, texts: Mapping[str, str] | None = None
) -> dict[str, Column]:
    """Return the column of each role: as given, else by a known name; `texts` are columns that hold no numbers.

    Raises
    ------
    Failure
        When a named column does not exist or none fits a required role; it lists what the file has.

    """
    chosen: dict[str, Column] = {}
    left_out = text_columns(texts or {})
    for role, column in given.items():
        name = _name_in_file(column.name, names)
        if name is None:
            near = suggestion(column.name, names)
            raise Failure(f"{source}: has no column '{column.name}' for the {role}{near}{left_out}")
        chosen[role] = column._replace(name=name)
    taken = {column.name for column in chosen.values()}
    for role, known in KNOWN_NAMES.items():
        name = next((found for word in known if (found := _name_in_file(word, names)) not in (None, *taken)), None)
        if role not in chosen and name is not None:
            chosen[role] = Column(name)
    if missing := [role for role in REQUIRED if role not in chosen]:
        example = ",".join(f"{role}=NAME" for role in missing)
        raise Failure(
            f"{source}: no column for {' and '.join(missing)}; say --columns {example} with one of {', '.join(names)}"
            f"{left_out}"
        )
    return chosen


def _name_in_file(wanted: str, names: Mapping[str, Channel]) -> str | None:
    """Find a column by its name, in any case, or by the part behind its last dot where that is unique."""
    if wanted in names:
        return wanted
    same = [name for name in names if name.lower() == wanted.lower()]
    ends = [name for name in names if name.lower().rpartition(".")[2] == wanted.lower()]
    return next((found[0] for found in (same, ends) if len(found) == 1), None)
