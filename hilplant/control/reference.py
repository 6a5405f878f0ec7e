"""The wanted speed of the crank: over time, as written on a command line, or as it is heard while a controller runs."""

import math
from collections.abc import Callable

from hilplant.failure import Failure
from hilplant.signals import INPUTS, WANTED

#: Wanted speed [rad/s] at a time [s] since the start.
Reference = Callable[[float], float]

#: What the heard wanted speed is until there is one; the fastest.
OWN, FASTEST_RAD_S = INPUTS[WANTED].default, INPUTS[WANTED].maximum


def wanted_speed(reference: Reference, now_s: float, heard_rad_s: float) -> float:
    """Return the wanted speed [rad/s]: the heard one, or the reference's where there is none (nan, below 0)."""
    return heard_rad_s if heard_rad_s >= 0.0 else reference(now_s)


def parse_reference(text: str) -> Reference:
    """Read one speed such as ``3.14``, or speeds over time such as ``0:3.14,10:3.77,15:0``; times [s] rise.

    Raises
    ------
    Failure
        Naming the entry and what would be right.

    """
    entries = [entry.strip() for entry in text.split(",")]
    if len(entries) == 1 and ":" not in text:
        speed = _number(text, "a speed in rad/s", FASTEST_RAD_S)
        return lambda _: speed
    times, speeds = [], []
    for entry in entries:
        time, colon, speed_text = entry.partition(":")
        if not colon:
            raise Failure(f"reference, entry '{entry}': write SECONDS:RAD_S, such as 10:3.77")
        times.append(_number(time, "a time in s", math.inf))
        speeds.append(_number(speed_text, "a speed in rad/s", FASTEST_RAD_S))
        if len(times) > 1 and times[-1] <= times[-2]:
            raise Failure(f"reference, entry '{entry}': time must be later than {times[-2]:g} s")

    def at(now_s: float) -> float:
        passed = [speed for time, speed in zip(times, speeds, strict=True) if time <= now_s]
        return passed[-1] if passed else 0.0

    return at


def _number(text: str, what: str, highest: float) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 <= value <= highest or math.isinf(value):
        limit = f" from 0 to {highest:g}" if math.isfinite(highest) else ", 0 or more"
        raise Failure(f"reference: '{text.strip()}' is not {what}{limit}")
    return value
