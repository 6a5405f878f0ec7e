"""What a cell of a table may hold: a number in several writings, a date, yes and no, a word for nothing, a unit."""

import math
import re
from datetime import date

from hilplant.units import quantity_of, unit_of

#: Words for a value that is not there.
NOTHING = frozenset(("", "-", "--", "nan", "na", "n/a", "#n/a", "#nv", "null", "none", "ol", "overflow", "over", "---"))
_YES = dict.fromkeys(("true", "yes", "on", "ja", "ein", "wahr", "high", "closed"), 1.0)
_TRUTH = _YES | dict.fromkeys(("false", "no", "off", "nein", "aus", "falsch", "low", "open"), 0.0)
_THOUSANDS = {
    ",": re.compile(r"[-+]?[1-9]\d{0,2}(\.\d{3})+(,\d*)?"),
    ".": re.compile(r"[-+]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?"),
}
#: Apostrophes and narrow, thin, fixed or plain blanks between thousands.
_BLANKS = re.compile(r"['\u2019\u202f\u2009\u00a0 ]")
_SPACED = re.compile(rf"[-+]?[1-9]\d{{0,2}}({_BLANKS.pattern}\d{{3}})+([.,]\d*)?")
_HEX = re.compile(r"0[xX][0-9A-Fa-f]+")
_DATE = re.compile(
    r"(?:(?P<first>\d{1,4})[-./](?P<month>\d{1,2})[-./](?P<last>\d{1,4})[T ,;]+)?"
    r"(?P<hour>\d{1,2}):(?P<minute>\d{2})(?::(?P<second>\d{2})(?:[.,:](?P<part>\d+))?)?"
    r"\s*(?P<half>[AaPp][Mm])?\s*(?P<zone>Z|[-+]\d{2}:?\d{2})?"
)
#: Minutes and seconds, as a spreadsheet shows the time of a measurement.
_MINUTES = re.compile(r"(?P<minute>\d{1,3}):(?P<second>[0-5]\d[.,]\d+)")
#: Stand where units stand, and are none.
_NO_UNITS = frozenset(("sequence", "bit", "bool"))


def is_unit(written: str) -> bool:
    """Say whether a cell can be nothing but a unit."""
    unit = unit_of(written)
    return unit.lower() in _NO_UNITS or (unit != "" and quantity_of(unit) is not None)


def moment_of(cell: str) -> tuple[int, float] | None:
    """Return a date as a number of days, 0 for a time without one, and the seconds of the day; None for neither."""
    if short := _MINUTES.fullmatch(cell.strip()):
        return 0, 60.0 * int(short["minute"]) + float(short["second"].replace(",", "."))
    found = _DATE.fullmatch(cell.strip())
    if found is None:
        return None
    hour = int(found["hour"])
    if found["half"]:
        hour = hour % 12 + 12 * (found["half"].lower() == "pm")
    part = float(f"0.{found['part']}") if found["part"] else 0.0
    seconds = 3600.0 * hour + 60.0 * int(found["minute"]) + int(found["second"] or 0) + part
    if found["first"] is None:
        return 0, seconds
    first, month, last = (int(found[name]) for name in ("first", "month", "last"))
    year, day = (first, last) if first > 31 else (last, first)
    month, day = (day, month) if month > 12 else (month, day)
    try:
        return date(year if year > 99 else 2000 + year, month, day).toordinal(), seconds
    except ValueError:
        return None


def number_of(cell: str, decimal: str) -> float | None:
    """Return the number in a cell, NaN for a word that says there is none; None for anything else."""
    plain = cell.strip().replace("\u2212", "-")
    word = plain.lower()
    if word in NOTHING:
        return math.nan
    if word in _TRUTH:
        return _TRUTH[word]
    if _HEX.fullmatch(plain):
        return float(int(plain, 16))
    if _SPACED.fullmatch(plain):
        plain = _BLANKS.sub("", plain)
    if _THOUSANDS[decimal].fullmatch(plain):
        plain = plain.replace("." if decimal == "," else ",", "")
    elif decimal == "," and "." in plain:
        return None
    try:
        return float(plain.replace(decimal, ".")) if "_" not in plain else None
    except ValueError:
        return None


def in_thousands(cell: str, decimal: str) -> bool:
    """Say whether a cell is one to three digits and three more behind the sign that is not the decimal one."""
    return bool(_THOUSANDS[decimal].fullmatch(cell)) and len(re.findall(r"[.,]", cell)) == 1


def kind_of(cell: str, decimal: str) -> str:
    """Say what a cell is: "" for nothing, else number, date or text."""
    if cell.strip().lower() in NOTHING:
        return ""
    if number_of(cell, decimal) is not None:
        return "number"
    return "date" if moment_of(cell) is not None else "text"
