"""A current or a speed over the time, out of a file as an instrument wrote it: by unit and name, never by position."""

from collections.abc import Callable
from pathlib import Path

from uncertainties import UFloat

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.measurements.channels import Channels
from hilplant.measurements.columns import KNOWN_NAMES, Column, has_unit, text_columns, unit_scale
from hilplant.measurements.files import NoTime, Origin, read_channels
from hilplant.measurements.resampling import checked

#: Names that say the quantity and, where no unit stands beside them, its SI unit.
_NAMES = {"current": (*KNOWN_NAMES["current"], "i"), "speed": ("speed_rad_s", "w", "omega", "ω")}
_RIGHT = {"current": "'i [A]' or 'i [mA]'", "speed": "'w [rad/s]' or 'n [rpm]'"}
#: What a table of two columns without a head has, by the names that they get: the time [s] and the quantity.
_HEADLESS = ("column1", "column2")


def fitted(path: Path, role: str, law: Callable[[Floats, Floats], UFloat]) -> UFloat:
    """Return what a law finds in the samples of a file: of its time [s] and of its "current" [A] or "speed" [rad/s].

    Raises
    ------
    Failure
        Naming file and columns, when nothing says which column it is or its unit is not one, and for what the law says.

    """
    channels = _channels(path, role)
    name = _column(channels, path, role)
    place = f"{path}, column '{name}'"
    samples, _ = checked(channels[name], place)
    try:
        return law(samples.time_s, samples.values * unit_scale(place, role, samples.unit))
    except Failure as error:
        raise Failure(f"{place}: {error}") from error


def _channels(path: Path, role: str) -> Channels:
    origin = Origin(path)
    try:
        return read_channels(origin)
    except NoTime as error:
        if error.columns != _HEADLESS:
            names = ", ".join(error.columns) + text_columns(error.texts)
            text = f"write 't [s]' or 't [ms]' for it and {_RIGHT[role]} for the {role}"
            raise Failure(f"{path}: no column is known as the time among {names}; {text}") from error
    return read_channels(origin._replace(time=Column(_HEADLESS[0])))


def _column(channels: Channels, path: Path, role: str) -> str:
    """Return the only column in a unit of the quantity, else the only one that is called so and has no unit."""
    if tuple(channels) == _HEADLESS[1:] and not channels[_HEADLESS[1]].unit:
        return _HEADLESS[1]
    called = [name for name in channels if name.lower() in _NAMES[role]]
    of_unit = [name for name, channel in channels.items() if channel.unit and has_unit(role, channel.unit)]
    both = [name for name in called if name in of_unit]
    found = both or of_unit or [name for name in called if not channels[name].unit]
    if len(found) == 1:
        return found[0]
    written = ", ".join(f"{name} [{channel.unit}]" if channel.unit else name for name, channel in channels.items())
    many, right = ("more than one", "keep one") if found else ("no", f"write it as {_RIGHT[role]}")
    raise Failure(f"{path}: {many} column is known by unit or name as the {role} among {written}; {right}")
