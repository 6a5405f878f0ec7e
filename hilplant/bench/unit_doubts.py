"""Units of a database's signal and of the plant's that contradict each other, and what to write then."""

import math

from hilplant.bus.mapping import Link, SignalMapping
from hilplant.units import conversion, quantity_of, unit_of

#: A scale that makes up for the unit is right within this share, an offset within so much of the plant's unit.
_SHARE = 0.01
_OFFSET = 0.5


def unit_doubt(made: Link, mapping: SignalMapping) -> str:
    """Return in words where the units of a mapping's two ends contradict each other; nothing where they do not.

    A unit that is not known says nothing, nor does any where `choices` decide. A scale below 0 is another direction, an
    offset of anything but a temperature another zero: neither is a unit's.
    """
    plant, written = made.plant, (made.database.unit or "").strip()
    unit, own = unit_of(written), unit_of(plant.unit)
    quantity = quantity_of(unit)
    if unit in ("", own) or quantity is None or made.table is not None:
        return ""
    ends = f"it is in {written}, and {plant.name} " + (f"in {plant.unit}" if plant.unit else "has no unit")
    if quantity != quantity_of(own):
        # a scale of the user's own, such as that of a shunt, leads from one to the other; a prefix's does not
        its_own = not any(_near(mapping.scale, scale) for scale in (1.0, conversion(unit, quantity)[0]))
        return "" if its_own else f"{ends}: {_remedy(made, 'map another signal, or write the scale between the two')}"
    scale, offset = conversion(unit, own)
    if quantity == "K":
        fits = math.isclose(mapping.scale, scale, rel_tol=_SHARE) and abs(mapping.offset - offset) <= _OFFSET
    else:
        scale, offset, fits = math.copysign(scale, mapping.scale), mapping.offset, _near(mapping.scale, scale)
    keys = {"scale": scale, "offset": offset}
    wanted = ", ".join(f"{key}: {value:.9g}" for key, value in keys.items() if value != float(key == "scale"))
    entry = f"write '{mapping.database_signal}: {{signal: {plant.name}, {wanted}}}'"
    return "" if fits else f"{ends}: {_remedy(made, entry)}"


def _near(scale: float, wanted: float) -> bool:
    return math.isclose(abs(scale), wanted, rel_tol=_SHARE)


def _remedy(made: Link, for_numbers: str) -> str:
    """Return what to write: of a flag and a choice, what stands for each of their values."""
    values = {"flag": "off and on", "choice": ", ".join(made.plant.choices)}.get(made.plant.kind)
    return f"say by choices which of its values are {values}" if values else for_numbers
