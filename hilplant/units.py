"""Conversion constants and the units of others, used only where numbers enter or leave; inside, everything is SI."""

import math
import re
import unicodedata
from contextlib import suppress

RAD_PER_DEG = math.pi / 180.0
SECOND_NS = 1_000_000_000
MILLISECOND_NS = 1_000_000
MICROSECOND_NS = 1_000
TURN_RAD = 2.0 * math.pi
RAD_PER_S_PER_RPM = TURN_RAD / 60.0

#: By the SI unit of a quantity: its units, each with the factor that leads to that one. A ratio has no unit.
FACTORS: dict[str, dict[str, float]] = {
    "": {"": 1.0, "%": 1e-2},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "d": 86400.0},
    "V": {"V": 1.0, "mV": 1e-3, "kV": 1e3, "uV": 1e-6},
    "A": {"A": 1.0, "mA": 1e-3, "kA": 1e3, "uA": 1e-6},
    "m": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "km": 1e3, "inch": 0.0254},
    "m/s": {
        "m/s": 1.0, "km/h": 1.0 / 3.6, "mph": 0.44704, "kn": 1852.0 / 3600.0, "mm/s": 1e-3, "cm/s": 1e-2,
        "mm/min": 1e-3 / 60.0, "mm/h": 1e-3 / 3600.0,
    },
    "m/s2": {"m/s2": 1.0},
    "rad": {"rad": 1.0, "mrad": 1e-3, "deg": RAD_PER_DEG, "rev": TURN_RAD},
    "rad/s": {
        "rad/s": 1.0, "mrad/s": 1e-3, "deg/s": RAD_PER_DEG, "rpm": RAD_PER_S_PER_RPM, "rev/s": TURN_RAD,
    },
    "rad/s2": {"rad/s2": 1.0, "deg/s2": RAD_PER_DEG},
    "Hz": {"Hz": 1.0, "kHz": 1e3},
    "K": {"K": 1.0, "degC": 1.0, "degF": 5.0 / 9.0},
    "N": {"N": 1.0, "mN": 1e-3, "daN": 10.0, "kN": 1e3},
    "Nm": {"Nm": 1.0, "mNm": 1e-3, "Nmm": 1e-3, "Ncm": 1e-2, "kNm": 1e3},
    "W": {"W": 1.0, "mW": 1e-3, "kW": 1e3},
    "J": {"J": 1.0, "kJ": 1e3, "Wh": 3600.0, "kWh": 3.6e6},
    "ohm": {"ohm": 1.0, "mohm": 1e-3, "kohm": 1e3},
    "As": {"As": 1.0, "mAh": 3.6, "Ah": 3600.0},
    "Pa": {"Pa": 1.0, "hPa": 1e2, "kPa": 1e3, "mbar": 1e2, "bar": 1e5},
    "kg": {"kg": 1.0},
}  # fmt: skip
_QUANTITIES = {unit: quantity for quantity, units in FACTORS.items() for unit in units}
#: What the zeros of temperatures are in K.
_ZEROS_K = {"degC": 273.15, "degF": 459.67 * 5.0 / 9.0}
#: Other writings, in whatever case, without blanks, dots and stars.
_WRITINGS = {
    writing: unit
    for unit, writings in {
        "%": "percent pct prozent",
        "s": "second seconds sec secs sekunde sekunden",
        "ms": "millisecond milliseconds msec",
        "us": "microsecond microseconds",
        "min": "minute minutes minuten",
        "h": "hour hours hr stunde stunden",
        "V": "v volt volts",
        "mV": "millivolt millivolts",
        "A": "a ampere amperes amp amps",
        "mA": "milliampere milliamps",
        "m": "meter metre meters metres",
        "m/s": "m/s m/sec ms-1 mps",
        "km/h": "km/h kmh kph kmph km/hr kmh-1",
        "mph": "mph mi/h mile/h miles/h",
        "kn": "knot knots",
        "m/s2": "m/s2 ms-2",
        "rad": "rad radian radians",
        "deg": "deg degree degrees °",
        "rev": "rev turn turns",
        "rad/s": "rad/s rad/sec rads-1",
        "deg/s": "deg/s deg/sec degs-1 dps °/s °/sec °s-1",
        "rpm": "rpm 1/min min-1 /min u/min r/min rev/min rot/min tr/min upm",
        "rev/s": "rev/s r/s u/s rps",
        "rad/s2": "rad/s2 rads-2",
        "deg/s2": "deg/s2 °/s2",
        "Hz": "hz hertz 1/s s-1",
        "kHz": "khz",
        "K": "kelvin degk °k",
        "degC": "degc °c c celsius deg_c",
        "degF": "degf °f f fahrenheit deg_f",
        "ohm": "ohm ohms ω",
    }.items()
    for writing in writings.split()
}
_BETWEEN = re.compile(r"[\s.·⋅*^]")


def unit_of(written: str) -> str:
    """Return a unit in its short form: "Volt" is V, "N m" Nm, either letter mu is u, brackets go; others stay."""
    with suppress(UnicodeError):
        written = written.encode("cp1252").decode("utf-8")  # text of the one kind that was read as the other
    plain = unicodedata.normalize("NFKC", written.translate({0xBA: "°", 0x2DA: "°"}))
    plain = plain.strip().strip("[]()").strip().translate({0x3BC: "u", 0x2212: "-"})
    close = _BETWEEN.sub("", plain)
    return close if close in _QUANTITIES else _WRITINGS.get(close.lower(), plain)


def quantity_of(unit: str) -> str | None:
    """Return the SI unit of what a unit, in its short form, measures; None for a word that is no unit."""
    return _QUANTITIES.get(unit)


def conversion(unit: str, into: str) -> tuple[float, float]:
    """Return scale and offset that lead from a value in one unit to the same in another one of its quantity.

    Raises
    ------
    KeyError
        When these are not short forms of units of one quantity.

    """
    factors = FACTORS[_QUANTITIES[unit]]
    zeros_k = _ZEROS_K.get(unit, 0.0) - _ZEROS_K.get(into, 0.0)
    return factors[unit] / factors[into], zeros_k / factors[into]
